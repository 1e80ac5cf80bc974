"""Figures of a scenario whose parameters have distributions: spread, shares, risk of a limit."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.polynomial_chaos import fit_chaos
from vehicledyn.analyse.reliability import Reliability, failing_chance
from vehicledyn.analyse.sobol_indices import sobol_samples
from vehicledyn.analyse.uncertainty import (
    failing,
    first_order,
    first_order_shares,
    samples,
    second_order,
    spread,
)
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.base.step_memory import Memory, Shelf
from vehicledyn.base.units import shown
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.studies.mistakes import Mistakes
from vehicledyn.studies.uncertainty.cases import Limited, RandomCases
from vehicledyn.studies.uncertainty.checks import check_method, note_mistakes
from vehicledyn.studies.uncertainty.report import Risk, UncertaintyReport

Floats = NDArray[np.float64]

_REACH = 1.959963984540054
"""Standard errors of a 95 % interval."""

_UNEVEN = 0.01
"""Part of the second derivatives by which they may differ from their transpose."""

_MISSED = 0.05
"""Part of the variance that an expansion may miss without a warning."""

_UNSURE = 0.05
"""Standard error of a share of the variance that is not warned of."""

_FEWEST = 4
"""Sets of runs that Sobol indices are computed from."""


def find_uncertainty(
    loaded: LoadedScenario,
    of: Sequence[str],
    parameters: Mapping[str, Mapping[str, Any]],
    *,
    method: str,
    number: int,
    seed: int,
    limits: Mapping[str, Mapping[str, Any]],
    progress: Progress,
    runs: Memory | None = None,
    mistakes: Mistakes | None = None,
) -> UncertaintyReport:
    """Return how the figures of a scenario scatter.

    Parameters
    ----------
    loaded
        The scenario.
    of
        Key figures of the run, or figures of channels such as ``max(chassis.roll)``.
    parameters
        Distribution of each uncertain parameter: ``kind`` and its numbers.
    method
        One of :data:`METHODS`.
    number
        Runs; of Sobol indices those of each sample, a power of two; of a reliability lines.
    seed
        Equal seeds give equal results.
    limits
        By figure ``at_most`` or ``at_least``, whose risk is wanted.
    progress
        Called with what is going on.
    runs
        Runs that are known, to which further ones are added.
    mistakes
        Where what is wrong is noted, of a file that was checked; None for what is no file.

    Raises
    ------
    InputError
        If a name, distribution, method or limit means nothing.
    NumericalError
        If a run fails.
    """
    if method not in METHODS:
        raise InputError(f"method '{method}' is unknown; known are {', '.join(METHODS)}")
    if mistakes is None:
        mistakes = Mistakes()
        check_method(mistakes, method, number, limits, seed)
        note_mistakes(
            mistakes, loaded, of=of, parameters=parameters, limits=limits, progress=progress
        )
        mistakes.refuse()
    cases = RandomCases.of(
        loaded,
        of=list(of),
        parameters=parameters,
        limits=limits,
        mistakes=mistakes,
        progress=progress,
    )
    cases.runs = runs or Memory(Shelf())
    return METHODS[method](cases, number, seed)


def _by_slopes(cases: RandomCases, *_: int) -> UncertaintyReport:
    values, slopes = cases.gradients_at(cases.means)
    found = first_order(values, slopes, cases.laws)
    return cases.report("first_order", found, shares=first_order_shares(slopes, cases.laws))


def _by_curvatures(cases: RandomCases, *_: int) -> UncertaintyReport:
    values, slopes, curvatures = cases.curvatures()
    uneven = np.abs(curvatures - np.swapaxes(curvatures, 1, 2)).max(axis=(1, 2))
    for item, missed, size in zip(
        cases.quantities, uneven, np.abs(curvatures).max(axis=(1, 2)), strict=True
    ):
        if missed > _UNEVEN * size:
            cases.notes.append(
                f"warning: the second derivatives of {item.name} are not symmetric by "
                f"{missed / size:.1%}: it is not smooth enough for them; take samples"
            )
    even = 0.5 * (curvatures + np.swapaxes(curvatures, 1, 2))
    found, shares, totals = second_order(values, slopes, even, cases.laws)
    return cases.report("second_order", found, shares=shares, totals=totals)


def _by_indices(cases: RandomCases, number: int, seed: int) -> UncertaintyReport:
    found = sobol_samples(cases.figures_at, cases.laws, number, seed)
    complete = found.complete()
    if len(complete.one) < _FEWEST:
        raise NumericalError(
            f"{number - len(complete.one)} of {number} sets of runs have one that failed, too many "
            f"for indices: take method sequence; the first: {cases.failures[0]}"
        )
    shares = complete.shares()
    if shares.first_error.max() > _UNSURE or shares.total_error.max() > _UNSURE:
        cases.notes.append(
            "warning: shares of the variance have standard errors of up to "
            f"{max(shares.first_error.max(), shares.total_error.max()):.0%}: take a larger number, "
            "or method polynomial_chaos where figures are smooth"
        )
    return cases.report(
        "sobol",
        spread(_known(found.independent)),
        shares=shares,
        figures=np.array(cases.known),
        risks=list(_counted(cases, found.independent)),
    )


def _known(figures: Floats) -> Floats:
    """Return the rows (number, m) of runs that did not fail."""
    return figures[np.isfinite(figures).all(axis=1)]


def _by_samples(method: str) -> Callable[[RandomCases, int, int], UncertaintyReport]:
    def sampled(cases: RandomCases, number: int, seed: int) -> UncertaintyReport:
        drawn = samples(cases.laws, number, seed, scrambled=method != "monte_carlo")
        figures = cases.figures_at(drawn)
        risks = list(_counted(cases, figures))
        kept = np.isfinite(figures).all(axis=1)
        if method != "polynomial_chaos":
            return cases.report(method, spread(figures[kept]), figures=figures, risks=risks)
        chaos = fit_chaos(cases.laws, drawn[kept], figures[kept])
        cases.notes.append(f"{len(chaos.powers)} polynomials up to degree {chaos.degree}")
        for item, missed in zip(cases.quantities, chaos.missed, strict=True):
            warning = "warning: " if missed > _MISSED else ""
            cases.notes.append(
                f"{warning}of runs left out the polynomials miss {missed:.2g} of the variance of "
                f"{item.name}"
            )
        # where runs fail the polynomials know nothing: what is left is a sample by itself
        found = chaos.spread if kept.all() else spread(figures[kept])
        return cases.report(method, found, shares=chaos.shares(), figures=figures, risks=risks)

    return sampled


def _by_nearest(cases: RandomCases, number: int, seed: int) -> UncertaintyReport:
    values, slopes = cases.gradients_at(cases.means)
    found, shares = first_order(values, slopes, cases.laws), first_order_shares(slopes, cases.laws)
    risks = []
    for limit in cases.limited():
        k, sign = limit.place, -1.0 if limit.is_upper else 1.0

        def margin(
            point: Floats, k: int = k, sign: float = sign, limit: Limited = limit
        ) -> tuple[float, Floats]:
            value, slope = cases.gradients_at(point)
            return sign * (float(value[k]) - limit.value), sign * slope[k]

        def alone(point: Floats, k: int = k, sign: float = sign, limit: Limited = limit) -> float:
            return sign * (float(cases.values_at(point)[k]) - limit.value)

        chance = failing_chance(cases.laws, margin, alone, number, seed)
        reach = _REACH * chance.error + chance.most
        low, high = (float(np.clip(chance.chance + side * reach, 0.0, 1.0)) for side in (-1.0, 1.0))
        name = cases.quantities[k].name
        words = _words(cases, limit)
        risks.append((name, words, chance.chance, low, high))
        cases.notes.extend(_nearest(cases, f"{name} {words}", chance))
    return cases.report("reliability", found, shares=shares, risks=risks)


def _nearest(cases: RandomCases, words: str, chance: Reliability) -> Iterator[str]:
    """Yield what is known of the nearest failing points."""
    if chance.note:
        yield f"warning: {words}: {chance.note}"
    about = cases.about
    for number, point in enumerate(chance.points):
        parts = [
            f"{name} = {shown(float(point.parameters[k]), about[name].unit)} "
            f"({point.importance[k]:.1%})"
            for k, name in enumerate(cases.names)
        ]
        yield (
            f"{words}: reliability index {point.distance:.4g}, by first order "
            f"{point.first_order:.3g}; {'also' if number else 'most'} likely at {', '.join(parts)}"
        )
    if len(chance.points) > 1:
        yield (
            f"warning: {words}: {len(chance.points)} regions were found, and their chances are "
            "summed; there may be more: samples show it where the chance is not too small"
        )
    elif chance.points:
        yield (
            f"{words}: chance and interval are those of the region around this point; "
            f"{chance.n_starts} searches from other sides found no further one"
        )


def _counted(cases: RandomCases, figures: Floats) -> Iterator[Risk]:
    """Yield the share of samples beyond each limit, with its interval."""
    for limit in cases.limited():
        share, low, high = failing(figures[:, limit.place], limit.value, above=limit.is_upper)
        yield cases.quantities[limit.place].name, _words(cases, limit), share, low, high


def _words(cases: RandomCases, limit: Limited) -> str:
    side = "above" if limit.is_upper else "below"
    return f"{side} {shown(limit.value, cases.quantities[limit.place].unit)}"


METHODS: dict[str, Callable[[RandomCases, int, int], UncertaintyReport]] = {
    "first_order": _by_slopes,
    "second_order": _by_curvatures,
    "monte_carlo": _by_samples("monte_carlo"),
    "sequence": _by_samples("sequence"),
    "sobol": _by_indices,
    "polynomial_chaos": _by_samples("polynomial_chaos"),
    "reliability": _by_nearest,
}
