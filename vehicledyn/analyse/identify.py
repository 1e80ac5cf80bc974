"""Least squares with covariance, confidence intervals, and what the data cannot tell.

Bard (1974), Nonlinear Parameter Estimation, chapters 7 and 10.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import NumericalError

Floats = NDArray[np.float64]

_WORSE = 10.0
"""Times the length of the first residuals that each one has where there is no motion."""

_BLIND = 1e-7
"""Singular value of the scaled Jacobian, as a part of the largest, of a blind combination."""


@dataclass(frozen=True)
class Estimate:
    """Parameters (n,) with their covariance (n, n) and 95 % intervals (n, 2).

    ``variance`` is that of the weighted residuals, one if the noise was as given, ``data_variance``
    that without what was known before; ``leverage`` (m,) is which part of each value those of all
    others do not decide; ``blind`` are
    combinations (k, n) of scaled parameters that the data cannot tell; ``whiteness`` is the
    largest autocorrelation of residuals in its own standard errors; ``n_runs`` counts evaluations,
    ``failures`` are those that came to nothing; ``message`` says how the search ended, and
    ``was_stopped`` whether that was by taking all runs that it may.
    """

    values: Floats
    covariance: Floats
    intervals: Floats
    variance: float
    data_variance: float
    leverage: Floats
    blind: Floats
    whiteness: float
    n_runs: int
    failures: tuple[str, ...] = ()
    message: str = "converged"
    was_stopped: bool = False


def estimate(
    residuals: Callable[[Floats], tuple[Floats, Floats]],
    *,
    start: Floats,
    bounds: tuple[Floats, Floats],
    most_runs: int | None = None,
    n_known: int = 0,
) -> Estimate:
    """Return the parameters of least weighted squares.

    Parameters
    ----------
    residuals
        Returns weighted residuals (m,) and their Jacobian (m, n); raises NumericalError where
        there are none, from where the search retreats.
    start
        Where to begin, shape (n,).
    bounds
        Lowest and highest values, shape (n,) each.
    most_runs
        Evaluations after which the best point so far is returned; None for a hundred a parameter.
    n_known
        How many residuals, the last, are no data but what was known before.

    Raises
    ------
    NumericalError
        If there are no residuals at the start.
    """
    from scipy.optimize import least_squares
    from scipy.stats import t as student

    known: dict[bytes, tuple[Floats, Floats]] = {}
    failures: list[str] = []

    def at(x: Floats) -> tuple[Floats, Floats]:
        key = x.tobytes()
        if key not in known:
            try:
                known[key] = residuals(x)
            except NumericalError as error:
                if not known:
                    raise
                failures.append(str(error))
                first = next(iter(known.values()))
                size = float(np.sqrt(first[0] @ first[0])) or 1.0
                known[key] = np.full(len(first[0]), _WORSE * size), first[1]
        return known[key]

    found = least_squares(
        lambda x: at(x)[0],
        start,
        jac=lambda x: at(x)[1],
        bounds=bounds,
        x_scale=bounds[1] - bounds[0],
        xtol=1e-12,
        ftol=1e-12,
        gtol=1e-12,
        max_nfev=most_runs,
    )
    was_stopped = found.status == 0
    message = f"stopped after {len(known)} runs, the most allowed" if was_stopped else found.message
    values = np.asarray(found.x, dtype=float)
    left, jacobian = at(values)
    scale = bounds[1] - bounds[0]
    free = len(left) - len(values)
    variance = float(left @ left / free)
    columns, sizes, rows = np.linalg.svd(jacobian * scale, full_matrices=False)
    blind = sizes <= _BLIND * sizes[0]
    leverage = np.sum(columns[:, ~blind] ** 2, axis=1)
    data = slice(len(left) - n_known)
    inverse = np.where(blind, np.inf, 1.0 / np.where(blind, 1.0, sizes) ** 2)
    seen = np.where(blind, 0.0, inverse)
    covariance = variance * (rows.T * seen) @ rows * np.outer(scale, scale)
    deviation = np.sqrt(np.diag(covariance))
    lost = (
        np.any(np.abs(rows[blind]) > 1e-3, axis=0) if blind.any() else np.zeros(len(values), bool)
    )
    deviation = np.where(lost, np.inf, deviation)
    reach = float(student.ppf(0.975, free)) * deviation
    intervals = np.stack([values - reach, values + reach], axis=1)
    return Estimate(
        values,
        covariance,
        intervals,
        variance,
        float(left[data] @ left[data] / np.sum(1.0 - leverage[data])),
        leverage,
        rows[blind],
        _whiteness(left[data]),
        len(known),
        tuple(failures),
        "converged" if found.success else str(message),
        was_stopped,
    )


def _whiteness(residuals: Floats) -> float:
    """Return the largest autocorrelation of up to twenty lags, in errors of white noise."""
    centred = residuals - np.mean(residuals)
    power = float(centred @ centred)
    lags = range(1, min(20, len(centred) // 4) + 1)
    if power == 0.0 or not lags:
        return 0.0
    found = [abs(float(centred[:-lag] @ centred[lag:])) / power for lag in lags]
    return float(max(found) * np.sqrt(len(centred)))
