"""The reference line of an OpenCRG road: places, headings and heights, and the way back.

The line is a polygon; between its corners the long sections run parallel to it, and cross
sections halve the angles of the corners, as in the reference library of ASAM OpenCRG.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.spatial import cKDTree

from vehicledyn.road.opencrg.data import CrgData
from vehicledyn.road.opencrg.payload import Array, Flags, Indices

_CURVATURE_LENGTH = 0.5
_PARALLEL = 1e-10
_SMALLEST_RADIUS = 1e-6
_LARGEST_CURVATURE = 1e6


@dataclass(frozen=True, eq=False)
class ReferenceLine:
    """Corners of a reference line at equal steps of u.

    Parameters
    ----------
    start, step
        First u and its step [m].
    x, y
        Corners, shape (n_u,) [m].
    heading
        Of the piece that ends at each corner, shape (n_u,), or None for a straight line [rad].
    ends
        Heading at the start and at the end, along which the line goes on [rad].
    closes
        Whether the line is continued to a closed one where its ends allow it.
    """

    start: float
    step: float
    x: Array
    y: Array
    heading: Array | None
    ends: tuple[float, float]
    closes: bool = False

    @property
    def stop(self) -> float:
        """Last u [m]."""
        return self.start + self.step * (len(self.x) - 1)

    @cached_property
    def closed(self) -> tuple[float, float] | None:
        """Range of u of the closed line [m]; None where its ends do not meet."""
        (m1, m2), (n1, n2) = ((math.cos(p), math.sin(p)) for p in self.ends)
        along = m1 * n1 + m2 * n2
        if along <= 0.5:
            return None
        dx, dy = self.x[0] - self.x[-1], self.y[0] - self.y[-1]
        after, before = (dy * m2 + dx * m1) / along, (-dy * n2 - dx * n1) / along
        if after <= 0.0 or before >= 0.0:
            return None
        first = self.start + 0.5 * before * along
        last = self.stop + 0.5 * after * along
        across = m1 * n2 - m2 * n1
        if abs(across) > _PARALLEL:
            to_meet = (m1 * dy - m2 * dx) / across
            from_meet = (n1 * dy - n2 * dx) / across
            if to_meet >= 0.0 and from_meet <= 0.0:
                first, last = self.start + from_meet, self.stop + to_meet
        return float(first), float(last)

    def moved(
        self, angle: float, centre: tuple[float, float], by: tuple[float, float]
    ) -> ReferenceLine:
        """Return the line turned by an angle [rad] about a centre [m] and then shifted [m]."""
        cosine, sine = math.cos(angle), math.sin(angle)
        dx, dy = self.x - centre[0], self.y - centre[1]
        return replace(
            self,
            x=centre[0] + cosine * dx - sine * dy + by[0],
            y=centre[1] + sine * dx + cosine * dy + by[1],
            heading=None if self.heading is None else self.heading + angle,
            ends=(self.ends[0] + angle, self.ends[1] + angle),
        )

    def wrapped(self, u: Array) -> Array:
        """Return u inside the range of a line that closes [m]."""
        if not self.closes or self.closed is None:
            return u
        first, last = self.closed
        rest = np.fmod(u - first, last - first)
        inside = np.where(rest > 0.0, rest + first, rest + last)
        return np.where((u < first) | (u > last), inside, u)

    def place(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Return x and y of places on the road [m]; straight on beyond both ends."""
        u = self.wrapped(u)
        part = (u - self.start) / self.step
        index = np.clip(np.floor(part).astype(np.intp), 0, len(self.x) - 2)
        part = part - index
        x, y = self._between(index, part, v)
        for outside, corner, heading, over in (
            (part < 0.0, 0, self.ends[0], part),
            (part > 1.0, -1, self.ends[1], part - 1.0),
        ):
            cosine, sine = math.cos(heading), math.sin(heading)
            x = np.where(outside, self.x[corner] + over * self.step * cosine - v * sine, x)
            y = np.where(outside, self.y[corner] + over * self.step * sine + v * cosine, y)
        return x, y

    def _between(self, index: Indices, part: Array, v: Array) -> tuple[Array, Array]:
        """Return places in a piece of the line, between the two halving cross sections."""
        ways = np.stack([np.diff(self.x), np.diff(self.y)], axis=-1)
        normals = _turned(ways)
        halving = np.vstack([normals[:1], _turned(ways[1:] + ways[:-1]), normals[-1:]])
        normal = normals[index]
        corners = []
        for at in (index, index + 1):
            across = halving[at]
            length = (across * normal).sum(axis=-1, keepdims=True)
            corners.append(across / np.where(abs(length) > _PARALLEL, length, 1.0))
        x, y = (
            (1.0 - part) * (of[index] + v * corners[0][..., axis])
            + part * (of[index + 1] + v * corners[1][..., axis])
            for axis, of in enumerate((self.x, self.y))
        )
        return x, y

    @cached_property
    def _corners(self) -> cKDTree:
        return cKDTree(np.column_stack([self.x, self.y]))

    def road_place(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Return u and v of places [m], each from the piece of the line beside it."""
        piece = self._piece(x, y)
        before, after = np.maximum(piece - 2, 0), np.minimum(piece + 1, len(self.x) - 1)
        x1, y1 = x - self.x[piece - 1], y - self.y[piece - 1]
        x2, y2 = self.x[piece] - x, self.y[piece] - y
        wx, wy = self.x[piece] - self.x[piece - 1], self.y[piece] - self.y[piece - 1]
        ax, ay = self.x[piece] - self.x[before], self.y[piece] - self.y[before]
        bx, by = self.x[after] - self.x[piece - 1], self.y[after] - self.y[piece - 1]
        from_first = (ax * x1 + ay * y1) / (ax * wx + ay * wy)
        to_second = (bx * x2 + by * y2) / (bx * wx + by * wy)
        u = self.start + (piece - 1 + from_first / (from_first + to_second)) * self.step
        v = (wx * y1 - wy * x1) / np.hypot(wx, wy)
        return self._beyond(x, y, u, v)

    def _beyond(self, x: Array, y: Array, u: Array, v: Array) -> tuple[Array, Array]:
        """Return u and v with those beyond the ends counted along the ends' headings."""
        loop = self.closed if self.closes else None
        first = u > loop[1] if loop else u < self.start
        last = u < loop[0] if loop else u > self.stop
        for outside, corner, heading, origin in (
            (first, 0, self.ends[0], self.start),
            (last & ~first, -1, self.ends[1], self.stop),
        ):
            cosine, sine = math.cos(heading), math.sin(heading)
            dx, dy = x - self.x[corner], y - self.y[corner]
            u = np.where(outside, origin + dx * cosine + dy * sine, u)
            v = np.where(outside, dy * cosine - dx * sine, v)
        return u, v

    def _piece(self, x: Array, y: Array) -> Indices:
        """Return the number of the corner at which each place's piece of the line ends."""
        last = len(self.x) - 1
        flat = np.column_stack([x.ravel(), y.ravel()])
        piece = np.maximum(self._corners.query(flat)[1], 1)
        for _ in range(last):
            onwards = np.minimum(piece + 1, last)
            ahead = self._ahead(flat, piece, onwards, piece - 1) & (piece < last)
            if not ahead.any():
                break
            piece = piece + ahead
        for _ in range(last):
            behind = self._ahead(flat, piece - 1, np.maximum(piece - 2, 0), piece) & (piece > 1)
            if not behind.any():
                break
            piece = piece - behind
        return np.asarray(piece.reshape(x.shape), dtype=np.intp)

    def _ahead(self, flat: Array, at: Indices, to: Indices, origin: Indices) -> Flags:
        """Return whether places lie beyond the normal at a corner, seen from origin to ``to``."""
        wx, wy = self.x[to] - self.x[origin], self.y[to] - self.y[origin]
        return (flat[:, 0] - self.x[at]) * wx + (flat[:, 1] - self.y[at]) * wy > 0.0

    def heading_and_curvature(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Return heading [rad] and curvature at v [1/m], over pieces of half a metre."""
        u = self.wrapped(u)
        part = (u - self.start) / self.step
        count = len(self.x)
        index = np.clip(np.floor(part).astype(np.intp), 0, count - 2)
        span = max(1, int(_CURVATURE_LENGTH / self.step))
        headings = np.empty(0) if self.heading is None else self.heading
        before, after = index < span, index + span >= len(headings)
        inner = np.clip(index, span, max(span, count - 1 - span))
        inner = np.minimum(inner, count - 1)
        low, high = np.maximum(inner - span, 0), np.minimum(inner + span, count - 1)
        dx0, dx1 = self.x[inner] - self.x[low], self.x[high] - self.x[inner]
        dy0, dy1 = self.y[inner] - self.y[low], self.y[high] - self.y[inner]
        curvature = (dx0 * dy1 - dy0 * dx1) / (self.step * span) ** 3
        curved = abs(curvature) > _PARALLEL
        radius = 1.0 / np.where(curved, curvature, 1.0) - v
        tight = abs(radius) < _SMALLEST_RADIUS
        at_v = np.where(tight, _LARGEST_CURVATURE, 1.0 / np.where(tight, 1.0, radius))
        curvature = np.where(curved, at_v, curvature)
        heading = headings[index] if len(headings) else np.full(u.shape, self.ends[1])
        heading = np.where(before, self.ends[0], np.where(after, self.ends[1], heading))
        return heading, np.where(before | after, 0.0, curvature)


def _turned(ways: Array) -> Array:
    """Return unit vectors to the left of ways, shape (n, 2)."""
    length = np.hypot(ways[:, 0], ways[:, 1])
    safe = np.where(length < _PARALLEL, 1.0, length)
    return np.column_stack([-ways[:, 1], ways[:, 0]]) / safe[:, None]


def reference_line(data: CrgData) -> ReferenceLine:
    """Return the reference line of a road, integrated from its headings.

    Where the file gives the end of the line, headings are integrated from both ends, weighted by
    the distance from them.
    """
    count, step = len(data.heights), data.step
    x: Array
    y: Array
    x0, y0 = (data.setting(f"reference_line_start_{axis}") for axis in ("x", "y"))
    first = data.setting("reference_line_start_phi")
    last = data.setting("reference_line_end_phi")
    if data.heading is None:
        along = step * np.arange(count, dtype=np.float64)
        x, y = x0 + along * math.cos(first), y0 + along * math.sin(first)
    else:
        ends = [data.settings.get(f"reference_line_end_{axis}") for axis in ("x", "y")]
        known = None not in ends
        x, y = (
            _integrated(origin, step * turn(data.heading), end if known else None)
            for origin, turn, end in zip((x0, y0), (np.cos, np.sin), ends, strict=True)
        )
    closes = data.options.get("refline_continuation", 0.0) == 1.0
    return ReferenceLine(data.start, step, x, y, data.heading, (first, last), closes)


def _integrated(start: float, steps: Array, end: float | None) -> Array:
    """Return the sums of steps[1:] from a start, led to an end where there is one."""
    count = len(steps)
    forwards = start + np.concatenate([[0.0], np.cumsum(steps[1:])])
    if end is None:
        return forwards
    result = end - np.concatenate([np.cumsum(steps[:0:-1])[::-1], [0.0]])
    result[0] = start
    for index in range(count - 1):
        weight = (index + 1) / (count - 1)
        ahead = result[index] + steps[index + 1]
        result[index + 1] = (1.0 - weight) * ahead + weight * result[index + 1]
    return result


def reference_heights(data: CrgData) -> Array | None:
    """Return the heights of the reference line [m], or None where it has no slope."""
    slope = data.setting("reference_line_start_s")
    if data.slope is None and slope == 0.0:
        return None
    count = len(data.heights)
    slopes = np.full(count, slope) if data.slope is None else data.slope
    rises = slopes * data.step
    start = data.setting("reference_line_start_z")
    end = data.settings.get("reference_line_end_z")
    if end is None:
        return start + np.concatenate([[0.0], np.cumsum(rises[1:])])
    heights = end - np.concatenate([np.cumsum(rises[:0:-1])[::-1], [0.0]])
    heights[0] = start
    for index in range(count - 2):
        weight = index / (count - 1)
        ahead = heights[index] + rises[index + 1]
        heights[index + 1] = (1.0 - weight) * ahead + weight * heights[index + 1]
    return heights
