"""Cubic splines through values at equal distances, without loading a library for it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def even_spline(values: Floats) -> Floats:
    """Return the polynomials of the cubic spline through values at 0, 1, 2 ...

    The third derivative is continuous at the second and the last but one place.

    Parameters
    ----------
    values
        Shape (n,), at least two; fewer than four give the polynomial through them.

    Returns
    -------
    Floats
        Coefficients, lowest power first, of u = x - k in cell k, shape (n - 1, 4). They are those
        of ``scipy.interpolate.CubicSpline``, which takes longer to load than to solve.
    """
    rises = np.diff(values)
    slopes = _slopes(rises)
    bend = slopes[:-1] + slopes[1:] - 2 * rises
    return np.stack((values[:-1], slopes[:-1], rises - slopes[:-1] - bend, bend), axis=1)


def _slopes(rises: Floats) -> Floats:
    """Return the slopes at all places, from the rises between them."""
    if rises.size == 1:
        return np.repeat(rises, 2)
    if rises.size == 2:
        middle = 0.5 * (rises[0] + rises[1])
        return np.array([2 * rises[0] - middle, middle, 2 * rises[1] - middle])
    right = np.empty(rises.size + 1)
    right[1:-1] = 3 * (rises[:-1] + rises[1:])
    right[0] = (5 * rises[0] + rises[1]) / 2
    right[-1] = (rises[-2] + 5 * rises[-1]) / 2
    return np.array(_solved(right.tolist()))


def _solved(found: list[float]) -> list[float]:
    """Return the solution of the tridiagonal equations, by elimination without pivoting."""
    n = len(found)
    diagonal, above = [1.0, *[4.0] * (n - 2), 1.0], [2.0, *[1.0] * (n - 2)]
    for k in range(1, n):
        factor = (1.0 if k < n - 1 else 2.0) / diagonal[k - 1]
        diagonal[k] -= factor * above[k - 1]
        found[k] -= factor * found[k - 1]
    found[-1] /= diagonal[-1]
    for k in range(n - 2, -1, -1):
        found[k] = (found[k] - above[k] * found[k + 1]) / diagonal[k]
    return found
