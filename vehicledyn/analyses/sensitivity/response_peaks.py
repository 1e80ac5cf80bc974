"""The largest gain of a frequency response in a range, its frequency, and what moves them.

At a peak the gain does not change with the frequency, so its derivative is that at the frequency
held. The frequency f of the peak follows from ∂|H|/∂f = 0: with L = ln |H|,

    df/dp = -(∂²L/∂f∂p) / (∂²L/∂f²)

The response is analytic in f, so derivatives by f are those of the values on a circle around it
(Lyness, Moler, 1967, Numerical differentiation of analytic functions, SIAM J. Numer. Anal. 4(2)).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.response_figures import key_figures
from vehicledyn.analyses.linear.linear_slopes import InputSlopes
from vehicledyn.base.errors import NumericalError

Floats = NDArray[np.float64]

_PLACES = 16
"""Points of the circle; its derivatives are exact to (1/5)^14 of the function."""
_NEAR = 0.2
"""Radius of the circle over the distance to the nearest pole."""
_GRID = 400
_STEPS = 30
_SETTLED = 1e-13


def find_peak(
    slopes: InputSlopes, row: int, column: int, low: float, high: float
) -> tuple[float, Floats, float, Floats]:
    """Return gain and frequency [Hz] of a peak, each with its derivatives by all parameters.

    Parameters
    ----------
    slopes
        The linearised model with its derivatives.
    row, column
        Number of the output and of the input.
    low, high
        Range of frequencies [Hz].

    Returns
    -------
    tuple
        Gain, its derivative (n_parameters,), frequency, its derivative (n_parameters,).

    Raises
    ------
    NumericalError
        If the gain is largest at an end of the range, or unbounded.
    """

    def gain(frequency: float) -> float:
        return abs(slopes.response(column, row, frequency)[0])

    n = slopes.system.n_states
    poles = np.asarray(np.linalg.eigvals(slopes.system.matrix[:n, :n]) / (2j * np.pi), complex)
    known = key_figures(
        gain, np.linspace(low, high, _GRID + 1), math.nan, [abs(p.real) for p in poles]
    )
    if known.peak_frequency is None or not math.isfinite(known.peak or math.inf):
        place = "unbounded" if known.peak_frequency is not None else "largest at an end"
        raise NumericalError(
            f"there is no peak between {low:g} and {high:g} Hz: the gain is {place}; ask for "
            "another range"
        )
    f = known.peak_frequency
    for _ in range(_STEPS):
        by_f, _ = _derivatives(slopes, row, column, f, poles)
        step = -float(by_f[1].real / by_f[2].real)
        f = min(max(f + step, low), high)
        if abs(step) <= _SETTLED * f:
            break
    value, slope = slopes.response(column, row, f)
    by_f, mixed = _derivatives(slopes, row, column, f, poles)
    moved = -(mixed.real / by_f[2].real)
    return abs(value), abs(value) * (slope / value).real, f, np.asarray(moved, dtype=float)


def _derivatives(
    slopes: InputSlopes, row: int, column: int, frequency: float, poles: NDArray[np.complex128]
) -> tuple[NDArray[np.complex128], NDArray[np.complex128]]:
    """Return ln H with two derivatives by f, and ∂²(ln H)/∂f∂p, shapes (3,), (n_parameters,)."""
    distance = min(float(np.abs(poles - frequency).min(initial=math.inf)), frequency)
    radius = _NEAR * distance
    around = np.exp(2j * np.pi * np.arange(_PLACES) / _PLACES)
    values, changes = [], []
    for point in frequency + radius * around:
        value, slope = slopes.response(column, row, complex(point))
        values.append(value)
        changes.append(slope / value)
    logs = np.log(np.array(values) / values[0])
    by_f = [math.factorial(k) * np.mean(logs * around ** (-k)) / radius**k for k in range(3)]
    mixed = np.mean(np.array(changes) * (around ** (-1))[:, None], axis=0) / radius
    return np.array(by_f), mixed
