"""Cubic splines that do not swing out between points.

A cubic spline through points is smooth and accurate where they resolve the curve, and swings out
beside a step: through a kerb of 80 mm in few points by hundreds of metres. Here an interval keeps
the slopes of the spline while it leaves the range of its two points by no more than twice what
the bend of the points around explains, and gets monotone slopes otherwise. The curve has a
continuous slope everywhere, and a continuous curvature where the spline was kept.

References
----------
Fritsch, Carlson (1980), Monotone piecewise cubic interpolation, SIAM J. Numer. Anal. 17, 238-246.
Huynh (1993), Accurate monotone cubic interpolation, SIAM J. Numer. Anal. 30, 57-100: the smaller
of neighbouring second differences as the measure of what bend the points resolve.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]

_ROUNDING = 1e-12
_PROBES = 15
_UNEVEN = 3.0
"""Ratio of distances side by side beyond which points resolve no bend."""


def level_slopes(places: Vector, values: Vector) -> Vector:
    """Return slopes at points of a curve through them that is level at both ends.

    Parameters
    ----------
    places
        Increasing places x of at least two points, shape (n,).
    values
        Values y there, shape (n,).
    """
    from scipy.interpolate import CubicSpline

    spline = CubicSpline(places, values, bc_type="clamped")
    slopes = np.asarray(spline(places, nu=1))
    slopes[[0, -1]] = 0.0
    return limited_slopes(places, values, slopes)


def limited_slopes(places: Vector, values: Vector, slopes: Vector) -> Vector:
    """Return slopes of cubics that stay within what the points resolve, shape (n,).

    Slopes of an interval whose cubic leaves the range of its points too far become those of a
    monotone curve; so do those of its neighbours where that makes them leave it.
    """
    monotone = _monotone_slopes(places, values)
    allowed = _resolved_excess(places, values) + _ROUNDING * float(np.ptp(values))
    found = slopes.copy()
    limited = np.zeros(len(places), dtype=bool)
    while True:
        beyond = excess(places, values, found) > allowed
        fresh = np.zeros(len(places), dtype=bool)
        fresh[:-1] |= beyond
        fresh[1:] |= beyond
        fresh &= ~limited
        if not fresh.any():
            return found
        limited |= fresh
        found[fresh] = monotone[fresh]


def excess(places: Vector, values: Vector, slopes: Vector) -> Vector:
    """Return how far each interval's cubic leaves the range of its ends, shape (n - 1,)."""
    steps, rises = np.diff(places), np.diff(values)
    first, last = slopes[:-1] * steps, slopes[1:] * steps
    # Roots of the slope 3 a u² + 2 b u + c of the cubic a u³ + b u² + c u over its first value.
    a, b, c = first + last - 2.0 * rises, 3.0 * rises - 2.0 * first - last, first
    low, high = np.minimum(rises, 0.0), np.maximum(rises, 0.0)
    beyond = np.zeros(len(steps))
    with np.errstate(divide="ignore", invalid="ignore"):
        root = np.sqrt(np.maximum(b * b - 3.0 * a * c, 0.0))
        shift = -(b + np.where(b < 0.0, -1.0, 1.0) * root)
        for u in (shift / (3.0 * a), c / shift):
            inside = (u > 0.0) & (u < 1.0)
            rise = np.where(inside, u * (c + u * (b + u * a)), 0.0)
            beyond = np.maximum(beyond, np.maximum(rise - high, low - rise))
    return beyond


def _resolved_excess(places: Vector, values: Vector) -> Vector:
    """Return twice the excess of the parabola that the points around an interval agree on.

    They agree where the bend at the four points around has one sign; distances that differ
    much, as beside a kerb, resolve nothing. Beyond both ends the curve goes on level.
    """
    steps = np.diff(places)
    beyond = np.pad(steps, 2, mode="edge")
    bends = np.diff(np.pad(np.diff(values) / steps, 2)) / (beyond[:-1] + beyond[1:])
    around = np.lib.stride_tricks.sliding_window_view(bends, 4)
    agreed = np.where(np.abs(np.sign(around).sum(axis=1)) == 4, np.abs(around).min(axis=1), 0.0)
    beside = np.lib.stride_tricks.sliding_window_view(beyond[1:-1], 3)
    even = beside.max(axis=1) <= _UNEVEN * beside.min(axis=1)
    return np.where(even, 0.5 * agreed * steps**2, 0.0)


def _monotone_slopes(places: Vector, values: Vector) -> Vector:
    """Return the slopes of Fritsch and Carlson, level at both ends and at extremes."""
    steps = np.diff(places)
    secants = np.diff(values) / steps
    slopes = np.zeros(len(places))
    before, after = secants[:-1], secants[1:]
    w1, w2 = 2.0 * steps[1:] + steps[:-1], steps[1:] + 2.0 * steps[:-1]
    same = np.sign(before) * np.sign(after) > 0.0
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        mean = (w1 + w2) / (w1 / before + w2 / after)
    slopes[1:-1] = np.where(same, mean, 0.0)
    return slopes


def largest_swing(
    places: Vector, values: Vector, curve: Callable[[Vector], Vector]
) -> tuple[int, float]:
    """Return the interval in which a curve through points leaves their range most, and how far.

    The second number is the distance from the range of the two points of the interval, by the
    range of the six points nearest to it [1]. Sines of five points a period reach 0.1.

    Parameters
    ----------
    places, values
        Points, places increasing, shape (n,).
    curve
        Values of the curve at any places between the first and the last.
    """
    low, high = np.minimum(values[:-1], values[1:]), np.maximum(values[:-1], values[1:])
    shares = np.linspace(0.0, 1.0, _PROBES + 2)[1:-1]
    probes = curve((places[:-1, None] + shares * np.diff(places)[:, None]).ravel())
    inside = np.asarray(probes).reshape(len(low), _PROBES)
    beyond = np.maximum(inside.max(axis=1) - high, low - inside.min(axis=1))
    padded = np.pad(values, 2, mode="edge")
    around = np.lib.stride_tricks.sliding_window_view(padded, 6)
    spread = np.maximum(
        np.ptp(around, axis=1), _ROUNDING * max(float(np.abs(values).max()), 1e-300)
    )
    worst = int(np.argmax(beyond / spread))
    return worst, max(float(beyond[worst] / spread[worst]), 0.0)
