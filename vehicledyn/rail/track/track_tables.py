"""The design of a track as curves that compiled equations look up, with the error of doing so."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.rail.track.alignment import Alignment
from vehicledyn.rail.track.riding_line import RidingLine, riding_line
from vehicledyn.rail.track.track import Side, TrackFrame
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.tables import CurveTable

Array = NDArray[np.float64]

WANTED_ERROR = 1e-8
"""Distance of the interpolated centre line from the exact one that is aimed at [m]."""

MOST_CELLS = 200_000
LONGEST = 200_000.0
"""Length of a track, of which each cell of the widest holds a part [m]."""

_WIDEST_CELL = 1.0
_COMMON = 1e-3
_CLOSE = 1e-3
_PROBES = (0.1, 0.3, 0.5, 0.7, 0.9)
_MOST_PROBED = 4000


@dataclass(frozen=True)
class Abscissa:
    """The number t of the cell, with its passed share, as a function of s: piecewise linear.

    Where the knots are equally far apart there is nothing to do, and t is s. Else each piece of
    the track has cells of its own width, so that all kinks of the design lie at knots. In each
    cell of a coarse grid there is one such change of width at most,

        t = line(s) + bend · max(s - kink, 0).
    """

    line: CurveTable | None = None
    kink: CurveTable | None = None
    bend: CurveTable | None = None

    def at(self, s: Scalar) -> tuple[Scalar, Scalar]:
        """Return t and dt/ds."""
        if self.line is None or self.kink is None or self.bend is None:
            return s, 1.0
        beyond, bend = s - self.kink.value(s), self.bend.value(s)
        t = self.line.value(s) + bend * ops.maximum(beyond, 0.0)
        return t, self.line.slope(s) + bend * ops.where(beyond >= 0.0, 1.0, 0.0)


@dataclass(frozen=True)
class CurvedLine:
    """A centre line given by tables: plan, heading and, where there are any, height and lean.

    Parameters
    ----------
    abscissa
        What the tables are functions of, t(s).
    x, y, heading
        Plan [m, m, rad].
    height
        Height of the centre line [m]; None on level track.
    roll
        Angle about x: by it the left rail is higher [rad]; None without cant.
    error
        Largest distance of the tables from the design, as measured between their knots [m].
    length
        Chainage of the end of the design [m].
    tightest
        Largest curvature of the design [1/m].
    smooth
        The frame that vehicles are described in.
    """

    abscissa: Abscissa
    x: CurveTable
    y: CurveTable
    heading: CurveTable
    height: CurveTable | None
    roll: CurveTable | None
    error: float
    length: float
    tightest: float
    smooth: RidingLine

    @property
    def is_straight(self) -> bool:
        """False; it may bend somewhere."""
        return False

    def frame(self, s: Scalar) -> TrackFrame:
        """Return the frame at an arc coordinate [m]."""
        t, rate = self.abscissa.at(s)
        rotation = rotations.turn(3, self.heading.value(t))
        yaw_slope = self.heading.slope(t) * rate
        stretch, cp, sp, dip = 1.0, 1.0, 0.0, 0.0
        if self.height is not None:
            slope = self.height.slope(t) * rate
            stretch = ops.sqrt(1.0 + slope * slope)
            cp, sp = 1.0 / stretch, -slope / stretch
            dip = -self.height.curvature(t) * (rate * cp) ** 2
            rotation = rotation @ rotations.turn_by(2, cp, sp)
        cr, sr, roll_slope = 1.0, 0.0, 0.0
        if self.roll is not None:
            roll = self.roll.value(t)
            cr, sr, roll_slope = ops.cos(roll), ops.sin(roll), self.roll.slope(t) * rate
            rotation = rotation @ rotations.turn_by(1, cr, sr)
        turning = ops.vector(
            roll_slope - yaw_slope * sp,
            dip * cr + yaw_slope * cp * sr,
            yaw_slope * cp * cr - dip * sr,
        )
        place = ops.vector(self.x.value(t), self.y.value(t), _value(self.height, t))
        return TrackFrame(place, rotation, stretch, turning)

    def curvature(self, s: Scalar) -> Scalar:
        """Return the curvature seen from above, positive to the left [1/m]."""
        t, rate = self.abscissa.at(s)
        return self.heading.slope(t) * rate

    def riding(self, s: Scalar) -> tuple[Scalar, ...]:
        """Return x, y, z [m], yaw, pitch and roll [rad] of the frame that rides along."""
        return self.smooth.coordinates(s)


@dataclass(frozen=True)
class TabledShift:
    """Displacement of both rails from tables; None where a rail is not displaced."""

    abscissa: Abscissa = Abscissa()
    left_lateral: CurveTable | None = None
    left_vertical: CurveTable | None = None
    right_lateral: CurveTable | None = None
    right_vertical: CurveTable | None = None
    ends: tuple[float, float] = (0.0, 0.0)

    def at(self, side: Side, s: Scalar) -> tuple[Scalar, Scalar]:
        """Return how far a rail is shifted to the left and upwards [m]."""
        t, _ = self.abscissa.at(s)
        left = side == "left"
        lateral = self.left_lateral if left else self.right_lateral
        vertical = self.left_vertical if left else self.right_vertical
        return _value(lateral, t), _value(vertical, t)


def _value(table: CurveTable | None, s: Scalar) -> Scalar:
    return 0.0 if table is None else table.value(s)


def centre_line(alignment: Alignment) -> tuple[CurvedLine, TabledShift | None]:
    """Return the centre line of a design as tables, and its gauge widening if there is any.

    All kinks of the design lie at knots, where places and slopes are exact. The cells are made
    shorter until the error in between is small.

    Raises
    ------
    InputError
        If the design is too long for tables.
    """
    if alignment.length > LONGEST:
        raise InputError(
            f"a track of {alignment.length:g} m is too long, {LONGEST:g} m at most; is the unit of "
            "its lengths right?"
        )
    grid = KnotGrid(alignment, max(_first_width(alignment), alignment.length / MOST_CELLS))
    while grid.error > WANTED_ERROR and 2 * grid.count <= MOST_CELLS:
        grid = KnotGrid(alignment, 0.5 * grid.width)
    return grid.line(), grid.widening()


def _first_width(alignment: Alignment) -> float:
    """Return a width of cells short enough for the tightest curve [m].

    Cubics through places and slopes are wrong by width⁴ κ³ / 384 in a circle.
    """
    tightest = _tightest(alignment)
    if tightest == 0.0:
        return _WIDEST_CELL
    return min(_WIDEST_CELL, float((192.0 * WANTED_ERROR / tightest**3) ** 0.25))


def _tightest(alignment: Alignment) -> float:
    probes = np.linspace(0.0, alignment.length, 2001)
    return float(np.abs(alignment.curvature(probes)).max())


class KnotGrid:
    """Knots along a design, one cell beyond either end, and exact values there.

    Parameters
    ----------
    alignment
        The design.
    width
        Width that no cell exceeds by more than the closeness of two kinks [m].
    """

    def __init__(self, alignment: Alignment, width: float) -> None:
        self.alignment, self.width = alignment, width
        kinks = _apart(alignment.kinks, max(_CLOSE, alignment.length / MOST_CELLS))
        lengths = np.diff(kinks)
        common = _common_width(lengths, width)
        counts = np.rint(lengths / common) if common else np.ceil(lengths / width - 1e-9)
        counts = np.maximum(counts, 1.0).astype(int)
        inner = [
            np.linspace(a, b, n, endpoint=False)
            for a, b, n in zip(kinks[:-1], kinks[1:], counts, strict=True)
        ]
        first, last = lengths[0] / counts[0], lengths[-1] / counts[-1]
        self.knots: Array = np.concatenate([[-first], *inner, [kinks[-1], kinks[-1] + last]])
        self.kinks, self.is_even = kinks, bool(common)
        self.numbers = np.concatenate([[0], np.cumsum(counts)]) + 1

    @property
    def count(self) -> int:
        """Number of cells."""
        return len(self.knots) - 1

    @cached_property
    def plan(self) -> Array:
        """Plan of the knots, x and y, shape (2, n_knots) [m]."""
        return self.alignment.plan(self.knots)

    def hermite(self, name: str, values: Array, before: Array, after: Array) -> CurveTable:
        """Return cubics through values; slopes on either side of each knot, a unit of s."""
        widths, first, last = np.diff(self.knots), values[:-1], values[1:]
        rising, arriving = widths * after[:-1], widths * before[1:]
        rows = [
            first,
            rising,
            3.0 * (last - first) - 2.0 * rising - arriving,
            2.0 * (first - last) + rising + arriving,
        ]
        start, step = (float(self.knots[0]), float(widths[0])) if self.is_even else (0.0, 1.0)
        return CurveTable(name, start, step, np.stack(rows, axis=1))

    @cached_property
    def abscissa(self) -> Abscissa:
        """What the tables are functions of."""
        if self.is_even:
            return Abscissa()
        kinks, length = self.kinks, self.kinks[-1]
        cells = math.ceil(length / np.diff(kinks).min()) + 2
        step = length / (cells - 2)
        begins = step * (np.arange(cells) - 1.0)
        rates = 1.0 / np.diff(self.knots)[np.concatenate([self.numbers - 1, [-1]])]
        place = np.interp(begins, self.knots, np.arange(len(self.knots), dtype=float))
        piece = np.searchsorted(kinks, begins + _CLOSE * 1e-3, side="right")
        beyond = begins < self.knots[0]
        place[beyond] = (begins[beyond] - self.knots[0]) * rates[0]
        following = np.append(kinks, 2.0 * length + 1.0)[piece]
        inside = following < begins + step - _CLOSE * 1e-3
        kink = np.where(inside, following, begins + step)
        bend = np.where(inside, np.append(np.diff(rates), 0.0)[np.minimum(piece, len(kinks))], 0.0)
        nothing = np.zeros(cells)
        return Abscissa(
            CurveTable("line", begins[0], step, np.stack([place, step * rates[piece]], axis=1)),
            CurveTable("kink", begins[0], step, np.stack([kink, nothing], axis=1)),
            CurveTable("bend", begins[0], step, np.stack([bend, nothing], axis=1)),
        )

    def t(self, s: Array) -> Array:
        """Return t of chainages, for checks."""
        if self.is_even:
            return s
        return np.asarray(np.interp(s, self.knots, np.arange(len(self.knots), dtype=float)))

    @cached_property
    def tables(self) -> dict[str, CurveTable]:
        """Tables of x, y and heading, and of height and roll where they are not zero."""
        design, s = self.alignment, self.knots
        heading = design.heading(s)
        cos, sin = np.cos(heading), np.sin(heading)
        bent = design.curvature(s, "before"), design.curvature(s)
        found = {
            "x": self.hermite("x of the track", self.plan[0], cos, cos),
            "y": self.hermite("y of the track", self.plan[1], sin, sin),
            "heading": self.hermite("heading of the track", heading, *bent),
        }
        height, lean = design.height(s), design.cant(s) / design.cant_base
        if np.any(height):
            slopes = design.gradient(s, "before"), design.gradient(s)
            found["height"] = self.hermite("height of the track", height, *slopes)
        if np.any(lean):
            steep = -1.0 / (design.cant_base * np.sqrt(1.0 - lean**2))
            slopes = steep * design.cant_slope(s, "before"), steep * design.cant_slope(s)
            found["roll"] = self.hermite("roll of the track", -np.arcsin(lean), *slopes)
        return found

    @cached_property
    def error(self) -> float:
        """Largest distance of table and design inside the cells [m].

        An angle counts by what it moves at half the distance of the rails.
        """
        design, tables = self.alignment, self.tables
        cells = np.arange(0, self.count, max(1, self.count // _MOST_PROBED))
        widths = np.diff(self.knots)[cells]
        probes = (self.knots[cells][:, None] + widths[:, None] * np.array(_PROBES)).ravel()
        behind = np.repeat(self.knots[cells], len(_PROBES))
        exact = np.repeat(self.plan[:, cells], len(_PROBES), axis=1) + design.advance(
            behind, probes
        )
        t = self.t(probes)
        x, y = (np.asarray(tables[name].value(t)) for name in ("x", "y"))
        half = 0.5 * design.cant_base
        errors = [np.hypot(x - exact[0], y - exact[1])]
        errors.append(half * np.abs(tables["heading"].value(t) - design.heading(probes)))
        if "height" in tables:
            errors.append(np.abs(tables["height"].value(t) - design.height(probes)))
        if "roll" in tables:
            lean = -np.arcsin(design.cant(probes) / design.cant_base)
            errors.append(half * np.abs(tables["roll"].value(t) - lean))
        return float(max(e.max() for e in errors))

    def line(self) -> CurvedLine:
        """Return the centre line."""
        t = self.tables
        level, lean = t.get("height"), t.get("roll")
        plan = (t["x"], t["y"], t["heading"])
        design = self.alignment
        return CurvedLine(
            self.abscissa, *plan, level, lean, self.error, design.length, _tightest(design),
            riding_line(design),
        )  # fmt: skip

    def widening(self) -> TabledShift | None:
        """Return the gauge widening, None if there is none."""
        design, s = self.alignment, self.knots
        shifts, after = design.widening(s), design.widening_slope(s)
        before = design.widening_slope(s, "before")
        left, right = (
            self.hermite(f"widening {side}", shifts[k], before[k], after[k])
            if np.any(shifts[k])
            else None
            for k, side in enumerate(("left", "right"))
        )
        if left is None and right is None:
            return None
        ends = (0.0, design.length)
        return TabledShift(self.abscissa, left_lateral=left, right_lateral=right, ends=ends)


def _apart(kinks: Array, least: float) -> Array:
    """Return kinks without those that are closer to one before than the least distance."""
    kept = [float(kinks[0])]
    for kink in kinks[1:-1]:
        if kink - kept[-1] >= least and kinks[-1] - kink >= least:
            kept.append(float(kink))
    return np.array([*kept, float(kinks[-1])])


def _common_width(lengths: Array, width: float) -> float:
    """Return a width that divides all lengths and is not much shorter than wanted, else zero."""
    counts = lengths / _COMMON
    whole = np.rint(counts)
    if np.abs(counts - whole).max() > 1e-6 or whole.min() < 1.0:
        return 0.0
    common = _COMMON * math.gcd(*[int(n) for n in whole])
    divided = common / math.ceil(common / width - 1e-9)
    return divided if divided > 0.2 * width else 0.0
