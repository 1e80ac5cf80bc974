"""The design of a track: curvature, cant, widening and gradient along the chainage, exactly.

Everything here is arithmetic with arrays. Where curvature, or the slope of cant, gauge or
gradient jumps, a value from either side can be asked for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vehicledyn.rail.track.pieces import Grade, TrackPiece
from vehicledyn.rail.track.transition_shapes import SHAPES, cubic_parabola

Array = NDArray[np.float64]
Near = Literal["before", "after"]
CantAbout = Literal["centre_line", "low_rail"]

_ENDLESS = 1e6
"""Length of the straight track beyond either end [m]."""

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(10)


@dataclass(frozen=True)
class Alignment:
    """Design of a track from chainage zero on; beyond both ends it is straight, leaning as there.

    Parameters
    ----------
    pieces
        Pieces of the plan in their order.
    grades
        Changes of the gradient, sorted; level before the first.
    cant_base
        Distance of the rail heads across which cant is the difference of heights [m].
    cant_about
        Whether the cant turns the track about its centre line or raises it about the low rail.
    """

    pieces: Sequence[TrackPiece]
    cant_base: float
    grades: Sequence[Grade] = ()
    cant_about: CantAbout = "centre_line"

    @property
    def length(self) -> float:
        """Length from chainage zero to the end [m]."""
        return float(self._begins[-1])

    @cached_property
    def kinks(self) -> Array:
        """Chainages where something jumps or bends, sorted, shape (n,) [m]."""
        ends = [e for g in self._rounded for e in (g[0], g[1])]
        ends += [] if self.cant_about == "centre_line" else self._level_places()
        inside = [s for s in ends if 0.0 < s < self.length]
        return np.unique(np.array([*self._begins, *inside]))

    def curvature(self, s: Array, near: Near = "after") -> Array:
        """Return the curvature seen from above, positive to the left [1/m]."""
        return self._bent(s, near)[0]

    def heading(self, s: Array) -> Array:
        """Return the angle from the first tangent, positive to the left [rad]."""
        return self._bent(s, "after")[1]

    def cant(self, s: Array) -> Array:
        """Return the height of the right rail over the left one [m]."""
        return self._ramped("cant", s, "after")[0]

    def cant_slope(self, s: Array, near: Near = "after") -> Array:
        """Return d cant/ds [1]."""
        return self._ramped("cant", s, near)[1]

    def widening(self, s: Array, near: Near = "after") -> tuple[Array, Array]:
        """Return the shift of the left and the right rail to the left, in that order [m]."""
        return self._widened(s, near, 0)

    def widening_slope(self, s: Array, near: Near = "after") -> tuple[Array, Array]:
        """Return d/ds of the shifts of both rails [1]."""
        return self._widened(s, near, 1)

    def height(self, s: Array) -> Array:
        """Return the height of the centre line [m]."""
        return self._graded(s, "after")[0] + self._lift * np.abs(self.cant(s))

    def gradient(self, s: Array, near: Near = "after") -> Array:
        """Return d height/ds [1]."""
        cant, slope = self._ramped("cant", s, near)
        rising = np.sign(cant) * slope
        flat = np.abs(slope) if near == "after" else -np.abs(slope)
        return self._graded(s, near)[1] + self._lift * np.where(cant == 0.0, flat, rising)

    def advance(self, begin: Array, end: Array) -> Array:
        """Return how far x and y move from one chainage to another, shape (2, ...) [m].

        Gauss-Legendre quadrature of (cos ψ, sin ψ) by ten points: exact to rounding where no kink
        lies in between and the heading changes by less than a radian.
        """
        half = 0.5 * (end - begin)
        places = 0.5 * (end + begin)[..., None] + half[..., None] * _NODES
        heading = self.heading(places)
        return np.stack([half * (np.cos(heading) @ _WEIGHTS), half * (np.sin(heading) @ _WEIGHTS)])

    def plan(self, s: Array) -> Array:
        """Return x and y at sorted chainages, zero at chainage zero, shape (2, n) [m]."""
        ends = np.union1d(np.append(s, 0.0), self.kinks)
        moved = np.cumsum(self.advance(ends[:-1], ends[1:]), axis=1)
        moved = np.concatenate([np.zeros((2, 1)), moved], axis=1)
        origin = moved[:, [int(np.searchsorted(ends, 0.0))]]
        return np.asarray((moved - origin)[:, np.searchsorted(ends, s)])

    def _level_places(self) -> list[float]:
        """Return where the cant changes its sign within a piece, so that the low rail changes."""
        found = []
        for begin, piece in zip(self._begins, self.pieces, strict=False):
            low, high = 0.0, piece.length
            if piece.cant[0] * piece.cant[1] < 0.0:
                for _ in range(60):
                    middle = 0.5 * (low + high)
                    same = float(self.cant(np.array(begin + middle))) * piece.cant[0] > 0.0
                    low, high = (middle, high) if same else (low, middle)
                found.append(float(begin) + low)
        return found

    # -- pieces by arrays --------------------------------------------------------------------

    @cached_property
    def _all(self) -> list[TrackPiece]:
        """The pieces between two that never end."""
        first, last = self.pieces[0], self.pieces[-1]
        ends = (first, 0), (last, 1)
        before, after = (
            TrackPiece(
                _ENDLESS, cant=(p.cant[k],) * 2, left=(p.left[k],) * 2, right=(p.right[k],) * 2
            )
            for p, k in ends
        )
        return [before, *self.pieces, after]

    @cached_property
    def _begins(self) -> Array:
        """Chainage where each piece begins, from the first of the file; the last is the end."""
        return np.concatenate([[0.0], np.cumsum([p.length for p in self.pieces])])

    @cached_property
    def _columns(self) -> dict[str, Array]:
        """Properties of all pieces, the endless ones included, as arrays."""
        pieces = self._all
        columns = {
            name: np.array([getattr(p, name) for p in pieces])
            for name in ("length", "curvature", "cant", "left", "right")
        }
        columns["begin"] = np.concatenate([[-_ENDLESS], self._begins])
        turned = np.zeros(len(pieces))
        for name in np.unique(self._shape_names):
            here, bends = np.asarray(self._shape_names == name), columns["curvature"]
            length, ends = columns["length"][here], (bends[here, 0], bends[here, 1])
            turned[here] = _bend(str(name), np.ones(len(length)), length, *ends)[1]
        columns["heading"] = np.concatenate([[0.0], np.cumsum(turned)])[:-1]
        return columns

    @cached_property
    def _shape_names(self) -> NDArray[np.str_]:
        return np.array([p.shape for p in self._all])

    def _where(self, s: Array, near: Near) -> tuple[NDArray[np.intp], Array]:
        """Return the number of the piece of each chainage, and the share of it passed."""
        begins = self._columns["begin"]
        k = np.clip(_number_of(begins, s, near), 0, len(begins) - 1)
        return k, (s - begins[k]) / self._columns["length"][k]

    def _bent(self, s: Array, near: Near) -> tuple[Array, Array]:
        s = np.asarray(s, dtype=float)
        k, u = self._where(s, near)
        curvature, heading = np.zeros(s.shape), np.array(self._columns["heading"][k])
        for name in np.unique(self._shape_names):
            here = np.asarray(self._shape_names[k] == name)
            if not here.any():
                continue
            piece, bends = k[here], self._columns["curvature"]
            found = _bend(
                str(name), u[here], self._columns["length"][piece], bends[piece, 0], bends[piece, 1]
            )
            curvature[here] = found[0]
            heading[here] += found[1]
        return curvature, heading

    def _ramped(self, what: str, s: Array, near: Near) -> tuple[Array, Array]:
        """Return the cant or the shift of a rail, and its slope."""
        s = np.asarray(s, dtype=float)
        k, u = self._where(s, near)
        first, last = self._columns[what][k, 0], self._columns[what][k, 1]
        share, slope = np.array(u), np.ones(s.shape)
        for name, shape in SHAPES.items():
            here = np.asarray(self._shape_names[k] == name)
            share[here], slope[here] = shape.share(u[here]), shape.slope(u[here])
        rise = last - first
        return first + rise * share, rise * slope / self._columns["length"][k]

    def _widened(self, s: Array, near: Near, which: int) -> tuple[Array, Array]:
        return self._ramped("left", s, near)[which], self._ramped("right", s, near)[which]

    # -- gradient ------------------------------------------------------------------------------

    @property
    def _lift(self) -> float:
        return 0.5 if self.cant_about == "low_rail" else 0.0

    @cached_property
    def _rounded(self) -> list[tuple[float, float, float, float]]:
        """Begin and end of each change of the gradient, and the slope before and after it."""
        rounded, before = [], 0.0
        for grade in self.grades:
            half = 0.5 * grade.radius * abs(grade.slope - before)
            rounded.append((grade.at - half, grade.at + half, before, grade.slope))
            before = grade.slope
        return rounded

    def _graded(self, s: Array, near: Near) -> tuple[Array, Array]:
        """Return height and slope of the gradient alone, the height zero at chainage zero."""
        height, slope = self._climbed(np.asarray(s, dtype=float), near)
        return height - self._climbed(np.zeros(()), "after")[0], slope

    @cached_property
    def _breaks(self) -> tuple[Array, Array, Array, Array]:
        """Where the rate of the gradient changes, and height, slope and rate from there on."""
        rows = [(-_ENDLESS, 0.0, 0.0)]
        for begin, end, before, after in self._rounded:
            if end > begin:
                rows.append((begin, before, (after - before) / (end - begin)))
            rows.append((end, after, 0.0))
        places, slopes, rates = np.array(rows).T
        widths = np.diff(places)
        rises = widths * (slopes[:-1] + 0.5 * rates[:-1] * widths)
        return places, np.concatenate([[0.0], np.cumsum(rises)]), slopes, rates

    def _climbed(self, s: Array, near: Near) -> tuple[Array, Array]:
        """Return height and slope of the gradient, the height zero before its first change."""
        places, heights, slopes, rates = self._breaks
        k = np.clip(_number_of(places, s, near), 0, None)
        beyond = s - places[k]
        return heights[k] + beyond * (slopes[k] + 0.5 * rates[k] * beyond), slopes[k] + rates[
            k
        ] * beyond


def _number_of(begins: Array, s: Array, near: Near) -> NDArray[np.intp]:
    """Return the number of the last place before each s, one at s counting as near says."""
    side: Literal["left", "right"] = "right" if near == "after" else "left"
    return np.asarray(np.searchsorted(begins, s, side=side) - 1)


def _bend(
    name: str, u: Array, length: Array | float, k0: Array | float, k1: Array | float
) -> tuple[Array, Array]:
    """Return curvature and change of heading at a share of a piece."""
    if name != "cubic_parabola":
        shape, change = SHAPES[name], np.asarray(k1) - k0
        return k0 + change * shape.share(u), length * (k0 * u + change * shape.swept(u))
    length, entering = np.asarray(length, dtype=float), np.asarray(k0) == 0.0
    end = np.where(entering, k1, k0)
    curvature, heading = cubic_parabola(np.where(entering, u, 1.0 - u) * length, length, end)
    whole = cubic_parabola(length, length, end)[1]
    return curvature, np.where(entering, heading, whole - heading)
