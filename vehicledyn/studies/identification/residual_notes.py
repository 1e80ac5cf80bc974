"""What residuals say of the noise given, and results of what was known before."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.identify import Estimate
from vehicledyn.base.units import shown
from vehicledyn.studies.identification.experiments import SampleFit
from vehicledyn.studies.identification.identified import Unknowns

Floats = NDArray[np.float64]

_REJECTED = 1e-3
"""Probability of residuals of the noise given, of all signals, below which they are noted."""

_LARGER, _SMALLER = 1.1, 0.9
"""Sizes of residuals, in the noise given, within which nothing is said of however many samples."""

_FAR = 3.0
"""Deviations of a prior beyond which it is contradicted."""

_DECIDED = 1e-9
"""Part of what is known of a parameter that its data give, below which they say nothing of it."""


def notes_on_noise(fits: Sequence[tuple[str, SampleFit]], found: Estimate) -> list[str]:
    """Return warnings of signals whose residuals the noise given does not explain.

    By the chi-square test of each signal, with as many degrees of freedom as its samples leave
    beside the parameters that they decide.

    Parameters
    ----------
    fits
        Names of signals and their fits, in the order of the residuals.
    found
        The estimate.
    """
    from scipy.stats import chi2

    large, small, begin = [], [], 0
    for name, fit in fits:
        rows = slice(begin, begin := begin + len(fit.residuals))
        free = float(np.sum(1.0 - found.leverage[rows]))
        if free < 1.0:
            continue
        power, least = float(fit.residuals @ fit.residuals), _REJECTED / len(fits)
        size = np.sqrt(power / free)
        words = f"'{name}' ({size:.3g} of it)"
        if size > _LARGER and chi2.sf(power, free) < least:
            large.append(words)
        elif size < _SMALLER and chi2.cdf(power, free) < least:
            small.append(words)
    intervals = "signals are weighed by the noise given, but the intervals go by the residuals"
    notes = []
    if large:
        notes.append(
            f"warning: residuals are larger than the noise given: {', '.join(large)}; it is "
            f"stated too small, or the model cannot follow the data; {intervals}"
        )
    if small:
        notes.append(
            f"warning: residuals are smaller than the noise given: {', '.join(small)}; it is "
            f"stated too large; {intervals}"
        )
    return notes


def notes_on_priors(unknowns: Unknowns, found: Estimate) -> list[str]:
    """Return warnings of priors that the data contradict.

    A prior does so that lies more than three deviations from the result, or from what the data
    say without it, by the deviations of both.
    """
    known = np.flatnonzero(np.isfinite(unknowns.prior))
    missed, _ = unknowns.prior_residuals(found.values)
    notes = []
    for k, miss, own in zip(known, missed, found.leverage[len(found.leverage) - len(known) :],
                            strict=True):  # fmt: skip
        of_data = 1.0 - float(own)
        if of_data < _DECIDED:
            continue
        alone = float(miss) / of_data
        both = np.sqrt(1.0 + max(found.data_variance, 1.0) * float(own) / of_data)
        if max(abs(miss), abs(alone) / both) > _FAR:
            unit = unknowns.units[k]
            value, prior, deviation = (
                shown(float(number[k]), unit)
                for number in (found.values, unknowns.prior, unknowns.deviation)
            )
            notes.append(
                f"warning: the data contradict the prior of '{unknowns.names[k]}', {prior} with a "
                f"deviation of {deviation}: the result {value} lies {abs(miss):.3g} deviations "
                f"from it, the data alone {abs(alone):.3g}"
            )
    return notes
