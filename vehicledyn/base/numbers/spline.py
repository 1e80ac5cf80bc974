"""Integral of samples along the cubic spline through them."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


_WINDOW = 1 << 15
"""Samples whose slopes are found together."""

MARGIN = 64
"""Samples beyond others that count for the spline through these, to rounding."""


def spline_integral(places: Vector, values: Vector) -> Vector:
    """Return the integral of a cubic spline from the first place to each, shape (n,).

    The spline is twice differentiable and, in its first two and last two parts, one cubic each
    (not-a-knot); through two or three samples it is the line or parabola.

    Parameters
    ----------
    places
        Increasing places x of at least two samples, shape (n,).
    values
        Values y there, shape (n,); the integral has the unit of y times that of x.

    References
    ----------
    de Boor (1978), A Practical Guide to Splines, chapter IV.
    """
    steps = np.diff(places)
    slopes = _windowed_slopes(steps, np.diff(values) / steps)
    parts = 0.5 * steps * (values[:-1] + values[1:]) + steps**2 / 12.0 * -np.diff(slopes)
    return np.concatenate([[0.0], np.cumsum(parts)])


def _windowed_slopes(steps: Vector, secants: Vector) -> Vector:
    """Return the slopes at the samples, found window by window so that memory stays bounded.

    What a slope owes to samples far away falls by a factor of about four a sample.
    """
    count = len(steps) + 1
    found = np.empty(count)
    for first in range(0, count, _WINDOW):
        last = min(first + _WINDOW, count)
        begin, end = max(0, first - MARGIN), min(count, last + MARGIN)
        slopes = _slopes(steps[begin : end - 1], secants[begin : end - 1])
        found[first:last] = slopes[first - begin : last - begin]
    return found


def _slopes(steps: Vector, secants: Vector) -> Vector:
    """Return the slopes of the spline at the samples."""
    if len(steps) == 1:
        return np.repeat(secants, 2)
    if len(steps) == 2:
        bend = (secants[1] - secants[0]) / (steps[0] + steps[1])
        return np.array(
            [
                secants[0] - bend * steps[0],
                secants[0] + bend * steps[0],
                secants[1] + bend * steps[1],
            ]
        )
    h, d = steps.tolist(), secants.tolist()
    first, last = h[0] + h[1], h[-1] + h[-2]
    diagonal = [h[1], *(2.0 * (a + b) for a, b in pairwise(h)), h[-2]]
    upper = [first, *h[:-1]]
    lower = [*h[1:], last]
    right = [
        ((h[0] + 2.0 * first) * h[1] * d[0] + h[0] ** 2 * d[1]) / first,
        *(3.0 * (h[k + 1] * d[k] + h[k] * d[k + 1]) for k in range(len(h) - 1)),
        (h[-1] ** 2 * d[-2] + (2.0 * last + h[-1]) * h[-2] * d[-1]) / last,
    ]
    return _solve_tridiagonal(lower, diagonal, upper, right)


def _solve_tridiagonal(
    lower: list[float], diagonal: list[float], upper: list[float], right: list[float]
) -> Vector:
    for k, below in enumerate(lower):
        factor = below / diagonal[k]
        diagonal[k + 1] -= factor * upper[k]
        right[k + 1] -= factor * right[k]
    found = np.array(right)
    found[-1] /= diagonal[-1]
    for k in range(len(upper) - 1, -1, -1):
        found[k] = (right[k] - upper[k] * found[k + 1]) / diagonal[k]
    return found
