"""Courses: plane paths by points, by a circle or by the reference line of an OpenCRG road."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.tables import CurveTable

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

LONGEST_STEP = 0.5
"""Distance of the knots of a course, and less where its points are nearer [m]."""

MOST_KNOTS = 200_000


class Course(Protocol):
    """A plane path by its length, to the left of which offsets count."""

    @property
    def length(self) -> float:
        """Length [m]; a circle has that of its circumference."""

    def place(self, station: Scalar) -> tuple[Scalar, Scalar]:
        """Return x and y at a station [m]."""

    def heading(self, station: Scalar) -> Scalar:
        """Return the heading at a station [rad]."""

    def curvature(self, station: Scalar) -> Scalar:
        """Return the curvature at a station, positive to the left [1/m]."""

    def tightest(self) -> tuple[float, float]:
        """Return the smallest radius and its station [m, m]."""


@dataclass(frozen=True)
class CircleCourse:
    """A circle through the origin, where it heads along x; to the left with R > 0."""

    radius: Scalar
    radius_value: float

    @property
    def length(self) -> float:
        """Length of one round [m]."""
        return 6.283185307179586 * abs(self.radius_value)

    def place(self, station: Scalar) -> tuple[Scalar, Scalar]:
        """Return x = R sin(s/R) and y = R (1 - cos(s/R)) [m]."""
        angle = station / self.radius
        return self.radius * ops.sin(angle), self.radius * (1.0 - ops.cos(angle))

    def heading(self, station: Scalar) -> Scalar:
        """Return s/R [rad]."""
        return station / self.radius

    def curvature(self, station: Scalar) -> Scalar:
        """Return 1/R [1/m]."""
        return 1.0 / self.radius

    def tightest(self) -> tuple[float, float]:
        """Return the radius, at the start [m, m]."""
        return abs(self.radius_value), 0.0


@dataclass(frozen=True)
class TableCourse:
    """A path by tables of x, y and heading over its length; straight beyond both ends.

    A closed one is driven round and round.
    """

    x: CurveTable
    y: CurveTable
    direction: CurveTable
    is_closed: bool

    @property
    def length(self) -> float:
        """Length [m]."""
        return self.x.stop

    def place(self, station: Scalar) -> tuple[Scalar, Scalar]:
        """Return x and y at a station [m]."""
        at = self._wrapped(station)
        return self.x.value(at), self.y.value(at)

    def heading(self, station: Scalar) -> Scalar:
        """Return the heading at a station [rad], of the first round."""
        return self.direction.value(self._within(station))

    def curvature(self, station: Scalar) -> Scalar:
        """Return the curvature at a station, zero beyond open ends [1/m]."""
        at = self._within(station)
        if self.is_closed:
            return self.direction.slope(at)
        inside = ops.where(station < 0.0, 0.0, ops.where(station > self.length, 0.0, 1.0))
        return inside * self.direction.slope(at)

    def tightest(self) -> tuple[float, float]:
        """Return the smallest radius and its station [m, m]."""
        import numpy as np

        stations = self.x.step * (np.arange(len(self.x.coefficients)) + 0.5)
        bends = np.abs(self.direction.slope(stations))
        at = int(np.argmax(bends))
        return float(1.0 / max(bends[at], 1e-12)), float(stations[at])

    def _wrapped(self, station: Scalar) -> Scalar:
        if not self.is_closed:
            return station
        return station - self.length * ops.floor(station / self.length)

    def _within(self, station: Scalar) -> Scalar:
        if self.is_closed:
            return self._wrapped(station)
        return ops.minimum(ops.maximum(station, 0.0), self.length)


def course_through(
    x: Floats, y: Floats, *, is_closed: bool = False, along_x: bool = False
) -> TableCourse:
    """Return the cubic spline through points over its own length.

    Parameters
    ----------
    x, y
        Points in order, no two neighbours at one place, shape (n,), n at least 2 [m].
    is_closed
        Whether the last point is followed by the first.
    along_x
        Whether an open course starts along x.
    """
    import numpy as np
    from scipy.interpolate import CubicSpline

    curve = _spline(x, y, is_closed=is_closed, along_x=along_x)
    knots = curve.x
    step = min(LONGEST_STEP, 0.25 * float(np.diff(knots).min()))
    fine = np.linspace(0.0, knots[-1], min(max(int(4 * knots[-1] / step), 100), 4 * MOST_KNOTS))
    speed = np.hypot(*curve(fine, 1).T)
    middle = np.hypot(*curve(0.5 * (fine[1:] + fine[:-1]), 1).T)
    pieces = np.diff(fine) * (speed[1:] + 4.0 * middle + speed[:-1]) / 6.0
    length = np.concatenate([[0.0], np.cumsum(pieces)])
    count = min(max(int(np.ceil(length[-1] / step)), 4), MOST_KNOTS)
    stations = np.linspace(0.0, length[-1], count + 1)
    at = CubicSpline(length, fine)(stations)
    places, slopes = curve(at), curve(at, 1)
    headings = np.unwrap(np.arctan2(slopes[:, 1], slopes[:, 0]))
    width = float(length[-1] / count)
    return TableCourse(
        CurveTable.through("course x", 0.0, width, places[:, 0]),
        CurveTable.through("course y", 0.0, width, places[:, 1]),
        CurveTable.through("course heading", 0.0, width, headings),
        is_closed,
    )


def _spline(x: Floats, y: Floats, *, is_closed: bool, along_x: bool) -> Any:
    """Return the cubic spline through points over the length of the chords, see above."""
    import numpy as np
    from scipy.interpolate import CubicSpline

    x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
    if is_closed and np.hypot(x[0] - x[-1], y[0] - y[-1]) > 0.0:
        x, y = np.append(x, x[0]), np.append(y, y[0])
    if is_closed:
        x[-1], y[-1] = x[0], y[0]
    chords = np.hypot(np.diff(x), np.diff(y))
    knots = np.concatenate([[0.0], np.cumsum(chords)])
    order: Any = "periodic" if is_closed else "not-a-knot"
    if along_x and not is_closed:
        order = ((1, np.array([1.0, 0.0])), (2, np.zeros(2)))
    return CubicSpline(knots, np.stack([x, y], axis=1), bc_type=order)


def largest_dip(
    x: Floats, y: Floats, *, is_closed: bool = False, along_x: bool = False
) -> tuple[float, int]:
    """Return how far a spline swings aside where its points do not bend, and behind which point.

    Between two points at which their polygon bends to one side a path bulges to the other; between
    bends to both sides it crosses over. All else is a dip: of the wrong side, or any beside a
    point where the polygon goes straight on. Parameters as of :func:`course_through`; the distance
    in m, the point counted from 0.
    """
    import numpy as np

    curve = _spline(x, y, is_closed=is_closed, along_x=along_x)
    places = curve(curve.x)
    chords = np.diff(places, axis=0)
    headings = np.arctan2(chords[:, 1], chords[:, 0])
    if is_closed:
        turns = np.diff(np.concatenate([headings[-1:], headings, headings[:1]]))
    else:
        inner = np.diff(headings)
        ends = inner[[0, -1]] if len(inner) else np.zeros(2)
        start = headings[0] if along_x else ends[0]
        turns = np.concatenate([[start], inner, ends[1:]])
    turns = np.arctan2(np.sin(turns), np.cos(turns))
    bends = np.where(np.abs(turns) < _STRAIGHT_ON, 0.0, np.sign(turns))
    parts = (np.arange(_DIP_SAMPLES) + 0.5) / _DIP_SAMPLES
    worst = 0.0, 0
    for k, chord in enumerate(chords):
        seen = curve(curve.x[k] + parts * (curve.x[k + 1] - curve.x[k])) - places[k]
        aside = (chord[0] * seen[:, 1] - chord[1] * seen[:, 0]) / np.hypot(*chord)
        before, after = bends[k], bends[k + 1]
        wrong = before * aside if before == after != 0.0 else np.abs(aside)
        dip = 0.0 if before * after < 0.0 else float(wrong.max())
        worst = max(worst, (dip, k))
    return worst


_STRAIGHT_ON, _DIP_SAMPLES = 1e-3, 20
"""Angle between chords that counts as none [rad], and samples between two points."""
