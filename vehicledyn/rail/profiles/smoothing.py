"""Smooth curves through measured points, with what smoothing moved.

Points (y, z) become two cubic splines over the length l along the profile, so that steep flanks
are treated as the tread is. Smoothing minimises

    Σ w_k |p(l_k) - p_k|² + λ ∫ |p''|² dl,   λ = (L/2π)⁴,   w_k the length that belongs to a point,

which leaves half of a wave of length L on the profile, nearly all of longer and nearly nothing of
shorter ones: noise of spacing h and size σ is left in the curvature as about
σ √(h/L) (2π/L)². Without smoothing the splines go through the points.

References
----------
Reinsch (1967), Smoothing by spline functions, Numerische Mathematik 10, 177-183.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.rail.profiles.profile import STEEPEST
from vehicledyn.rail.profiles.profile_pieces import Floats, QuinticTable, table

_FINEST = 2e-5
_FEWEST = 4


_SLOPE_NOISE = 2e-3
"""Noise of the slope that is left where smoothing is proposed [1]."""

_LONGEST = 20e-3
"""Longest wavelength that is proposed [m]."""

_SMALLEST = 1e-12
"""Scatter of points that counts as none [m]."""


class Smoothed(NamedTuple):
    """A smooth profile and how far the points lie from it along the normal, shape (n,) [m]."""

    table: QuinticTable
    distance: Floats

    @property
    def largest(self) -> float:
        """Largest distance of a point [m]."""
        return float(np.max(np.abs(self.distance)))

    @property
    def rms(self) -> float:
        """Root mean square of the distances [m]."""
        return float(np.sqrt(np.mean(self.distance**2)))


def smoothed(y: Floats, z: Floats, wavelength: float) -> Smoothed:
    """Return a smooth curve near points.

    Parameters
    ----------
    y, z
        Points in their order, y increasing, shape (n,) [m].
    wavelength
        Wavelength L of which half is left; zero for a curve through all points [m].

    Raises
    ------
    InputError
        If no part of the curve is a function of y.
    """
    length = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(y), np.diff(z)))])
    points = np.column_stack([y, z])
    values, bends = _spline(length, points, wavelength)
    count = max(2, min(len(y) * 8, int(length[-1] / _FINEST)))
    places = np.unique(np.concatenate([length, np.linspace(0.0, length[-1], count)]))
    position, rate, change = _evaluate(length, values, bends, places)
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = rate[:, 1] / rate[:, 0]
        bend = (change[:, 1] * rate[:, 0] - rate[:, 1] * change[:, 0]) / rate[:, 0] ** 3
    steep = rate[:, 0] <= np.abs(rate[:, 1]) / (2.0 * STEEPEST)
    usable = _widest_run(~steep, position[:, 0])
    if usable.stop - usable.start < _FEWEST:
        raise InputError("the curve through the points is steeper than 85 degrees everywhere")
    curve = table(position[usable, 0], position[usable, 1], slope[usable], bend[usable])
    # Along the normal: what is moved along the profile does not show.
    rates = _evaluate(length, values, bends, length)[1]
    moved = points - values
    across = (rates[:, 0] * moved[:, 1] - rates[:, 1] * moved[:, 0]) / np.hypot(*rates.T)
    return Smoothed(curve, across)


def slope_noise(scatter: float, spacing: float, wavelength: float) -> float:
    """Return the standard deviation of the slope of a smoothed curve through scattered points [1].

    Smoothing passes 1/(1 + (k/k_c)⁴) of a wave, k_c = 2π/λ, and white noise has the density
    σ² h/π over wave numbers k > 0, so that σ_slope² = σ² h k_c³/π ∫ x²/(1 + x⁴)² dx, with
    π/(8 √2) for the integral.

    Parameters
    ----------
    scatter, spacing, wavelength
        σ of the points, their distance h, and λ of which half is left [m].
    """
    edge = 2.0 * np.pi / wavelength
    return float(scatter * np.sqrt(spacing * edge**3 / (8.0 * np.sqrt(2.0))))


def proposed_wavelength(scatter: float, spacing: float) -> float:
    """Return the wavelength that leaves 2 mrad of noise in the slope, no more than 20 mm [m].

    Longer waves are the shape of a profile itself.
    """
    edge = (_SLOPE_NOISE / max(scatter, _SMALLEST)) ** 2 * 8.0 * np.sqrt(2.0) / spacing
    return float(min(2.0 * np.pi / np.cbrt(edge), _LONGEST))


def _widest_run(usable: NDArray[np.bool_], y: Floats) -> slice:
    """Return the run of true values that covers the most of y."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], usable.astype(int), [0]])))
    runs = edges.reshape(-1, 2)
    if not len(runs):
        return slice(0, 0)
    first, last = runs[int(np.argmax(y[runs[:, 1] - 1] - y[runs[:, 0]]))]
    return slice(int(first), int(last))


def _spline(length: Floats, points: Floats, wavelength: float) -> tuple[Floats, Floats]:
    """Return values and second derivatives of the natural smoothing spline, shape (n, 2) each."""
    from scipy.linalg import solveh_banded

    steps = np.diff(length)
    weights = np.empty(len(length))
    weights[1:-1] = 0.5 * (steps[1:] + steps[:-1])
    weights[0], weights[-1] = 0.5 * steps[0], 0.5 * steps[-1]
    penalty = (wavelength / (2.0 * np.pi)) ** 4
    # Q takes values to jumps of their slope, column k from points k, k + 1, k + 2.
    q = np.array([1.0 / steps[:-1], -1.0 / steps[:-1] - 1.0 / steps[1:], 1.0 / steps[1:]])
    jumps = sum(q[k][:, None] * points[k : len(points) - 2 + k] for k in range(3))
    scaled = [q[k] ** 2 / weights[k : len(points) - 2 + k] for k in range(3)]
    band = np.zeros((3, len(points) - 2))
    band[2] = (steps[:-1] + steps[1:]) / 3.0 + penalty * (scaled[0] + scaled[1] + scaled[2])
    inner = weights[1:-1]
    band[1, 1:] = steps[1:-1] / 6.0 + penalty * (
        q[1, :-1] * q[0, 1:] / inner[:-1] + q[2, :-1] * q[1, 1:] / inner[1:]
    )
    band[0, 2:] = penalty * q[2, :-2] * q[0, 2:] / inner[1:-1]
    bends = solveh_banded(band, jumps)
    pulled = np.zeros_like(points)
    for k in range(3):
        pulled[k : len(points) - 2 + k] += q[k][:, None] * bends
    ends = np.zeros((1, 2))
    return points - penalty * pulled / weights[:, None], np.concatenate([ends, bends, ends])


def _evaluate(
    length: Floats, values: Floats, bends: Floats, places: Floats
) -> tuple[Floats, Floats, Floats]:
    """Return value, first and second derivative of splines at places, shape (n, 2) each."""
    part = np.clip(np.searchsorted(length, places, side="right") - 1, 0, len(length) - 2)
    step = (length[part + 1] - length[part])[:, None]
    u = (places - length[part])[:, None] / step
    v0, v1, b0, b1 = values[part], values[part + 1], bends[part], bends[part + 1]
    rest = 1.0 - u
    value = rest * v0 + u * v1 + step**2 / 6.0 * ((rest**3 - rest) * b0 + (u**3 - u) * b1)
    rate = (v1 - v0) / step + step / 6.0 * ((3.0 * u**2 - 1.0) * b1 - (3.0 * rest**2 - 1.0) * b0)
    return value, rate, rest * b0 + u * b1
