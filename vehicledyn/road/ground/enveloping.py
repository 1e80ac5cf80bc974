"""Enveloping of short obstacles: rigid cams that roll over an outline, alone or in tandem.

A tyre swallows the edges of what is shorter than its contact patch. Schmeitz' model lets two
rigid cams of superelliptic outline, at a fixed distance, roll over the ground. Their mean height
is the effective height, the difference over their distance the effective slope of the ground
that the tyre feels (Pacejka, Tire and Vehicle Dynamics, 3rd ed. 2012, section 10.1.6). A circle
of the tyre's radius is the single cam of order two.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vehicledyn.symbolic.tables import CurveTable

Array: TypeAlias = NDArray[np.float64]

_FINEST = 2e-5
_MOST_CELLS = 400_000


@dataclass(frozen=True)
class EnvelopingCam:
    """A convex cam |s/length|ⁿ + |h/height|ⁿ = 1 whose lowest point is at s = 0.

    Parameters
    ----------
    length, height
        Half axes along the ground and upwards, positive [m].
    order
        Exponent n, above 1; 2 for an ellipse.
    """

    length: float
    height: float
    order: float

    def outline(self, s: Array) -> Array:
        """Return the height of the lower outline over the lowest point [m], infinite outside."""
        share = 1.0 - np.minimum(abs(s) / self.length, 1.0) ** self.order
        inside = abs(s) <= self.length
        return np.where(inside, self.height * (1.0 - share ** (1.0 / self.order)), np.inf)

    def place_of_slope(self, slope: Array) -> Array:
        """Return where the lower outline has a slope [m]."""
        steep = abs(slope) * self.length / self.height
        ratio = steep ** (self.order / (self.order - 1.0))
        return np.sign(slope) * self.length * (ratio / (1.0 + ratio)) ** (1.0 / self.order)

    def lift(self, x: Array, z: Array, at: Array) -> Array:
        """Return the heights of the lowest point of the cam as it rests on an outline [m].

        Parameters
        ----------
        x, z
            Corners of the outline, x never falling; equal x for vertical edges, shape (n,) [m].
        at
            Places of the lowest point along x, shape (m,) [m]; the outline reaches beyond the
            cam on both sides of each.
        """
        at = np.atleast_1d(np.asarray(at, dtype=float))
        order = np.argsort(at)
        places = at[order]
        highest = np.full(len(at), -np.inf)
        for corner, height in zip(x, z, strict=True):
            near = self._near(places, corner, corner)
            rest = height - self.outline(corner - places[near])
            highest[near] = np.maximum(highest[near], rest)
        for index in np.flatnonzero(np.diff(x) > 0.0):
            near = self._near(places, x[index], x[index + 1])
            slope = (z[index + 1] - z[index]) / (x[index + 1] - x[index])
            touch = places[near] + self.place_of_slope(np.asarray(slope))
            inside = (touch > x[index]) & (touch < x[index + 1])
            height = z[index] + slope * (touch - x[index]) - self.outline(touch - places[near])
            highest[near] = np.where(inside, np.maximum(highest[near], height), highest[near])
        result = np.empty_like(highest)
        result[order] = highest
        return result

    def even_lift(self, z: Array, step: float) -> Array:
        """Return the heights of the lowest point over outlines with corners at equal distances.

        Parameters
        ----------
        z
            Heights of the corners of one outline a column, shape (n, m) [m].
        step
            Distance of the corners [m].

        Returns
        -------
        Array
            Heights with the lowest point at every corner from which the cam lies within the
            outline, shape (n - 2 k, m) with k steps to the end of the cam [m].
        """
        reach = self.steps_to_end(step)
        count = len(z) - 2 * reach
        highest = np.full((count, z.shape[1]), -np.inf)
        for k in range(-reach, reach + 1):
            rest = self.outline(np.array(k * step))
            if np.isfinite(rest):
                np.maximum(highest, z[reach + k : reach + k + count] - rest, out=highest)
        slope = np.diff(z, axis=0) / step
        touch = self.place_of_slope(slope)
        before = np.arange(len(slope))[:, None] - reach
        at = np.ceil(before - touch / step).astype(int)
        height = z[:-1] + slope * ((at - before) * step + touch) - self.outline(touch)
        column = np.broadcast_to(np.arange(z.shape[1]), at.shape)
        inside = (at >= 0) & (at < count)
        np.maximum.at(highest, (at[inside], column[inside]), height[inside])
        return highest

    def steps_to_end(self, step: float) -> int:
        """Return the number of steps [m] that cover half the length of the cam."""
        return int(np.ceil(self.length / step - 1e-9))

    def _near(self, places: Array, first: float, last: float) -> slice:
        """Return the sorted places from which the cam reaches a stretch of the outline."""
        low = np.searchsorted(places, first - self.length)
        return slice(int(low), int(np.searchsorted(places, last + self.length, side="right")))


@dataclass(frozen=True)
class Tandem:
    """Two equal cams at a distance [m]; a distance of zero is one cam."""

    cam: EnvelopingCam
    spacing: float

    def height_and_slope(self, x: Array, z: Array, at: Array) -> tuple[Array, Array]:
        """Return effective height [m] and slope [1] at places of the middle of the cams [m].

        The slope is that between the two cams; for one cam that of its height.
        """
        at = np.atleast_1d(np.asarray(at, dtype=float))
        half = 0.5 * self.spacing
        if half == 0.0:
            height = self.cam.lift(x, z, at)
            return height, np.gradient(height, at) if len(at) > 1 else np.zeros(1)
        front, rear = self.cam.lift(x, z, at + half), self.cam.lift(x, z, at - half)
        return 0.5 * (front + rear), (front - rear) / self.spacing


@lru_cache(maxsize=8)
def enveloped_profile(
    tandem: Tandem, x: tuple[float, ...], z: tuple[float, ...]
) -> tuple[CurveTable, CurveTable | None]:
    """Return tables of effective height and slope over an outline that is level at both ends.

    Parameters
    ----------
    tandem
        The cams.
    x, z
        Corners of the outline [m].

    Returns
    -------
    tuple
        Height [m] by the place of the middle of the cams, and slope [1]; None for the slope of
        one cam, which is that of the height.
    """
    reach = 1.1 * (tandem.cam.length + tandem.spacing)
    first, last = x[0] - reach, x[-1] + reach
    corners = np.array([first - reach, *x, last + reach])
    heights = np.array([z[0], *z, z[-1]])
    cells = int(min(_MOST_CELLS, np.ceil((last - first) / _FINEST)))
    at = np.linspace(first, last, cells + 1)
    height, slope = tandem.height_and_slope(corners, heights, at)
    table = _table("effective height", at, height)
    return table, None if tandem.spacing == 0.0 else _table("effective slope", at, slope)


def _table(name: str, at: Array, values: Array) -> CurveTable:
    rows = np.column_stack([values[:-1], np.diff(values)])
    return CurveTable(name, float(at[0]), float(at[-1] - at[0]) / (len(at) - 1), rows)
