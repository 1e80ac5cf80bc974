"""Follow periodic orbits along a parameter, through folds, and find where they change.

References
----------
Keller (1977), Numerical solution of bifurcation and nonlinear eigenvalue problems: pseudo-
arclength continuation. Seydel (2010), Practical Bifurcation and Stability Analysis, 3rd ed.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.solve.engine import Vector
from vehicledyn.solve.periodic.autonomous import AutonomousField
from vehicledyn.solve.periodic.collocation import (
    Corrected,
    Direction,
    Scales,
    correct,
    dot,
    tangent_of,
)
from vehicledyn.solve.periodic.corners import behind_corner, corner_between
from vehicledyn.solve.periodic.cycle_points import (
    Branch,
    CyclePoint,
    Limits,
    ahead,
    between,
    cosine,
    moved,
    point_of,
)
from vehicledyn.solve.periodic.cycles_at import cycle_beside
from vehicledyn.solve.periodic.floquet import STABLE, multipliers_of
from vehicledyn.solve.periodic.kinks import Kinks, aligned, misalignment
from vehicledyn.solve.periodic.orbit import Orbit, adapted_mesh
from vehicledyn.solve.periodic.returning import returning
from vehicledyn.solve.periodic.shooting import Closed, closed, direction_of

Told = Callable[["CyclePoint"], None]

_NO_TURN = 1e-5
"""Scaled slope of the parameter along the branch below which its sign may be rounding [1]."""

_SMALLEST, _FIRST, _LARGEST = 1e-7, 0.05, 0.4
_SHARP, _SHARPLY = 0.5, 2e-3
_EASY, _HARD = 4, 7
_CHORD = 7, 11
"""Iterations of a step that may grow and of one that must shrink, with derivatives kept."""

_BEFORE = 1.0 - 1e-5, 1.0 - 1e-3, 0.7, 0.4
"""Parts of the way to a corner at which it is told, the first at which an orbit is found."""

_NEUTRAL = 1e-6
"""Distance from 1 at which a multiplier counts as 1 all along the branch."""

_LOCATED, _LOCATED_ROUGHLY = 1e-6, 1e-5
"""Part of a step to which special points are located; a fold's parameter errs by its square."""

_COMPLEX = 1e-6
_SHRUNK = 0.5
_REMESHED, _ALIGNED = 10, 1e-7
_REMESHED_AFTER = 10
"""Points after which the mesh of orbits that integration finds follows them."""

_GONE_ON = 0.5
"""Least part of a step that an orbit must be ahead; errors are as large as the smallest steps."""

_NEAR_ONE = 0.2
"""Distance of a multiplier from 1 beside a branch point: farther off the step is too large."""

_CORNERED = 2e-4
"""Step below which a corner of the branch is looked for where no orbit is found ahead."""


def follow_cycles(
    model: AutonomousField,
    start: Orbit,
    direction: Direction | None,
    limits: Limits,
    *,
    branch: Branch | None = None,
    told: Told | None = None,
    upwards: bool = True,
) -> Branch:
    """Return the branch of periodic orbits from one that is nearly one.

    Parameters
    ----------
    model
        The equations.
    start
        A guess of the first orbit.
    direction
        The side to which the branch is followed, for a start at a Hopf bifurcation the growing
        oscillation; None to follow it ``upwards`` in the parameter or downwards.
    limits
        Where it ends.
    branch
        Filled as points are found, so that they are kept where an interrupt comes.
    told
        Told each point.

    Raises
    ------
    NumericalError
        If not even the first orbit is found. A branch that is lost later says so in its ending.
    """
    result = Branch() if branch is None else branch
    tracer = _Tracer(model, limits, result, told or (lambda point: None))
    tracer.begin(start, direction, upwards=upwards)
    tracer.run()
    return result


@dataclass
class _Tracer:
    """A branch while it is followed."""

    model: AutonomousField
    limits: Limits
    branch: Branch
    told: Told
    step: float = _FIRST
    first_size: float = 0.0
    intervals: int = 0
    side: float = 0.0
    remeshed: int = 0

    @cached_property
    def kinks(self) -> Kinks:
        """What looks for kinks."""
        return Kinks(self.model)

    def begin(self, start: Orbit, direction: Direction | None, *, upwards: bool) -> None:
        """Find the first orbit."""
        self.intervals = start.intervals
        scales = self._scales(start)
        if direction is None:
            self._begin_at(start, scales, 1.0 if upwards else -1.0)
            return
        length = np.sqrt(dot(start, direction, direction, scales))
        along = direction.times(1.0 / length)
        found = correct(self.model, start, scales, along=along)
        exact = closed(self.model, found.orbit, parameter_scale=scales.parameter)
        self.first_size = float(np.ptp(start.states, axis=0).max())
        self._add(self._point(found, exact, scales, along))
        self.side = self._side(self.branch.points[0])

    def _begin_at(self, start: Orbit, scales: Scales, side: float) -> None:
        """Find the first orbit at the parameter of a guess.

        A simulated one, with contacts that begin and end, is closed by shooting; what is less
        near by collocation.
        """
        point = None
        if self.model.is_carried:
            along = Direction(np.zeros_like(start.states), 0.0, side)
            with suppress(NumericalError):
                point = point_of(closed(self.model, start), along, scales.parameter)
        if point is None:
            found, exact, _ = self._corrected(start, scales, None)
            along = Direction(np.zeros_like(found.orbit.states), 0.0, side)
            point = self._point(found, exact, scales, along)
        self._add(point)
        self.side = self._side(point)

    def run(self) -> None:
        """Follow the branch to its end."""
        while len(self.branch.points) < self.limits.points:
            base = next(p for p in reversed(self.branch.points) if not p.kind)
            point, size = self._next(base)
            if point is None:
                return
            self._special(base, point, size)
            if not self.limits.low <= point.orbit.parameter <= self.limits.high:
                self._finish_range(point)
                return
            self._add(point)
            if np.ptp(point.orbit.states, axis=0).max() < _SHRUNK * self.first_size:
                self._end("equilibrium", "the cycle shrinks to an equilibrium")
                return
        self._end("points", f"{self.limits.points} points are found")

    def _next(self, base: CyclePoint) -> tuple[CyclePoint | None, float]:
        """Return the next point and the step to it; None where the branch is lost."""
        why = ""
        while self.step > _SMALLEST:
            size = self._limited(base)
            try:
                point = self._step_from(base, size)
            except NumericalError as error:
                why, self.step = str(error), 0.4 * size
                behind = self._behind(base, size)
                if behind is None:
                    continue
                return behind, size
            if self._turn(base, point) < _SHARP and size > _SHARPLY:
                self.step = 0.5 * size
                continue
            easy, hard = _CHORD if point.passages is not None else (_EASY, _HARD)
            if point.iterations <= easy:
                quick = point.passages is not None and point.iterations <= _EASY
                self.step = min((2.5 if quick else 1.5) * size, _LARGEST)
            elif point.iterations >= hard:
                self.step = 0.6 * size
            return point, size
        value = base.orbit.parameter
        self._end("lost", f"lost near {self.model.parameter} = {value:.6g}: {why}")
        return None, 0.0

    def _behind(self, base: CyclePoint, size: float) -> CyclePoint | None:
        """Return a point behind a corner of the branch, None where there is none."""
        if size > _CORNERED or not base.sense:
            return None
        scales = self._scales(base.orbit)
        try:
            point, self.step = behind_corner(self.model, base, size, scales)
        except NumericalError:
            return None
        return replace(point, corner=min(size, corner_between(base, point, scales)))

    def _limited(self, base: CyclePoint) -> float:
        slope = abs(base.tangent.parameter)
        largest = self.limits.parameter_step / slope if slope else np.inf
        return float(min(self.step, largest))

    def _turn(self, before: CyclePoint, after: CyclePoint) -> float:
        """Return the cosine of the angle between the directions at two points."""
        scales = self._scales(after.orbit)
        first, second = moved(before.orbit, before.tangent, after.orbit.mesh), after.tangent
        return cosine(after.orbit, first, second, scales)

    def _step_from(self, base: CyclePoint, size: float) -> CyclePoint:
        """Return the point at a distance along the branch."""
        scales = self._scales(base.orbit)
        if self.model.is_carried:
            return self._shot_from(base, size, scales)
        mesh = self._mesh(base.orbit, scales, self.kinks.along(base.orbit))
        tangent = moved(base.orbit, base.tangent, mesh)
        guess = ahead(base.orbit.moved(mesh), tangent, size)
        found, exact, along = self._corrected(guess, scales, tangent)
        return self._point(found, exact, self._scales(found.orbit), along or tangent)

    def _shot_from(self, base: CyclePoint, size: float, scales: Scales) -> CyclePoint:
        """Return the point at a distance along the branch, found by integration alone.

        Where it is quick, as with compiled code, it needs no collocation, whose mesh would have to
        be fine where contacts begin and end.
        """
        mesh, near = base.orbit.mesh, base.passages
        if len(self.branch.points) >= self.remeshed + _REMESHED_AFTER or near is None:
            mesh, near = adapted_mesh(base.orbit, scales.states, base.orbit.intervals), None
            self.remeshed = len(self.branch.points)
        tangent = moved(base.orbit, base.tangent, mesh)
        guess = ahead(base.orbit.moved(mesh), tangent, size)
        exact = returning(self.model, guess, near, parameter_scale=scales.parameter, along=tangent)
        way = between(base.orbit.moved(mesh), exact.orbit)
        if not dot(exact.orbit, way, tangent, scales) > _GONE_ON * size:
            raise NumericalError("no other orbit is found")
        point = point_of(exact, tangent, scales.parameter, base.sense)
        if point.sense * base.sense < 0.0 and not _passes_one(base, point):
            raise NumericalError("an orbit of another leg of the branch is found")
        return point

    def _corrected(
        self, guess: Orbit, scales: Scales, along: Direction | None
    ) -> tuple[Corrected, Closed, Direction | None]:
        """Return the orbit near a guess, closed by the motion itself, and the direction.

        The mesh of the collocation gets finer until the motion closes the orbit that it finds.
        """
        found = correct(self.model, guess, scales, along=along)
        iterations = found.iterations
        for _ in range(_REMESHED):
            orbit = found.orbit
            kinks = self.kinks.along(orbit)
            if misalignment(orbit.mesh, kinks) > _ALIGNED:
                mesh = aligned(orbit.mesh, kinks)
            else:
                try:
                    exact = closed(self.model, orbit, parameter_scale=_free(scales, along))
                    return replace(found, iterations=iterations), exact, along
                except NumericalError:
                    if self.intervals >= self.limits.intervals:
                        raise
                finer = self.intervals + max(4, self.intervals // 3)
                self.intervals = min(self.limits.intervals, finer)
                mesh = self._mesh(orbit, scales, kinks)
            along = None if along is None else moved(orbit, along, mesh)
            found = correct(self.model, orbit.moved(mesh), scales, along=along)
        exact = closed(self.model, found.orbit, parameter_scale=_free(scales, along))
        return replace(found, iterations=iterations), exact, along

    def _mesh(self, orbit: Orbit, scales: Scales, kinks: Vector) -> Vector:
        """Return a mesh that spreads the error of an orbit, with points on its kinks."""
        return aligned(adapted_mesh(orbit, scales.states, self.intervals, kinks), kinks)

    def _point(
        self, found: Corrected, exact: Closed, scales: Scales, before: Direction
    ) -> CyclePoint:
        tangent = tangent_of(found, found.system.scales, before)
        length = np.sqrt(dot(found.orbit, tangent, tangent, scales))
        _, sense = direction_of(exact, scales.parameter, tangent)
        return CyclePoint(
            exact.orbit,
            multipliers_of(exact.passages),
            tangent.times(1.0 / length),
            found.iterations,
            sense=sense,
        )

    def _special(self, base: CyclePoint, after: CyclePoint, size: float) -> None:
        """Add the folds and bifurcations between two points."""
        found: list[tuple[float, CyclePoint]] = []
        turned = self._has_turned(after)
        if turned and _slope(base) * _slope(after) >= 0.0:
            found.append((0.0, replace(base, kind="fold")))
        for kind, measure in _MEASURES.items():
            low, high = measure(base), measure(after)
            wanted = turned if kind == "fold" else self._crosses(kind, base, after, turned)
            if low * high < 0.0 and wanted:
                located = self._locate(base, size, measure, after=after, kind=kind)
                if located is not None:
                    found.append((located[0], replace(located[1], kind=kind)))
        if base.multipliers.turning != after.multipliers.turning:
            located = self._torus(base, after, size)
            if located is not None:
                found.append((located[0], replace(located[1], kind="torus")))
        for _, point in sorted(found, key=lambda item: item[0]):
            if self.limits.low <= point.orbit.parameter <= self.limits.high:
                self._add(point)

    def _crosses(self, kind: str, base: CyclePoint, after: CyclePoint, turned: bool) -> bool:
        """Return whether a multiplier passes 1, elsewhere than at a fold, or -1."""
        place = -1.0 if kind == "period_doubling" else 1.0
        if turned and kind == "branch_point":
            return False
        nearest = [np.abs(p.multipliers.others - place).min() for p in (base, after)]
        return bool(min(nearest) > _NEUTRAL)

    def _has_turned(self, after: CyclePoint) -> bool:
        """Return whether the parameter now runs the other way, beyond rounding."""
        before, now = self.side, self._side(after)
        self.side = now or before
        return before * now < 0.0

    def _side(self, point: CyclePoint) -> float:
        slope = point.tangent.parameter / self._parameter_scale
        return float(np.sign(slope)) if abs(slope) > _NO_TURN else 0.0

    def _locate(
        self,
        base: CyclePoint,
        size: float,
        measure: Callable[[CyclePoint], float],
        *,
        after: CyclePoint,
        kind: str,
    ) -> tuple[float, CyclePoint] | None:
        """Return where a measure passes zero on a step, and the point there.

        Where points on the way are not found it is the nearest one that is, with a remark.
        """
        from scipy.optimize import brentq

        if after.corner is not None:
            return self._at_corner(base, after.corner)
        points: dict[float, CyclePoint] = {0.0: base, size: after}
        near = _LOCATED if base.passages is None else _LOCATED_ROUGHLY

        def value(part: float) -> float:
            if part not in points:
                points[part] = self._between(base, after, part, size)
            return measure(points[part])

        try:
            place = float(brentq(value, 0.0, size, xtol=near * size, maxiter=40, disp=False))
            value(place)
        except NumericalError:
            place = min(points, key=lambda part: abs(measure(points[part])))
            self._remark(kind, [p for _, p in sorted(points.items())], measure)
        except ValueError:
            return None
        return place, points[place]

    def _at_corner(self, base: CyclePoint, way: float) -> tuple[float, CyclePoint]:
        """Return a point just before a corner."""
        for part in _BEFORE:
            with suppress(NumericalError):
                return part * way, self._step_from(base, part * way)
        return 0.0, base

    def _remark(
        self, kind: str, points: list[CyclePoint], measure: Callable[[CyclePoint], float]
    ) -> None:
        """Tell between which points, in their order, one lies at which a measure passes zero."""
        ends = [
            f"{point.orbit.parameter:.8g}"
            for pair in pairwise(points)
            if measure(pair[0]) * measure(pair[1]) <= 0.0
            for point in pair
        ][:2] or [f"{p.orbit.parameter:.8g}" for p in (points[0], points[-1])]
        self.branch.remarks.append(
            f"{kind.replace('_', ' ')} not located: it lies on the branch between the cycles at "
            f"{self.model.parameter} = {' and '.join(ends)}; one of them is told"
        )

    def _between(self, base: CyclePoint, after: CyclePoint, part: float, size: float) -> CyclePoint:
        """Return a point on a step that has been made, a part of its size from the base."""
        if base.passages is None and after.passages is None:
            return self._step_from(base, part)
        first = base.orbit
        chord = between(first, after.orbit.moved(first.mesh))
        guess = ahead(first, chord, part / size)
        scale = self._scales(first).parameter
        exact = returning(self.model, guess, base.passages, parameter_scale=scale, along=chord)
        return point_of(exact, base.tangent, scale, base.sense)

    def _torus(
        self, base: CyclePoint, after: CyclePoint, size: float
    ) -> tuple[float, CyclePoint] | None:
        """Return where a complex pair crosses the unit circle, None if that is not how."""
        outside = max((base, after), key=lambda point: point.multipliers.turning)
        values = outside.multipliers.others
        grown = values[(values.imag > _COMPLEX) & (np.abs(values) > STABLE)]
        if not grown.size:
            return None
        crossing = grown[np.argmin(np.abs(grown))]

        def measure(point: CyclePoint) -> float:
            others = point.multipliers.others
            nearest = others[np.argmin(np.abs(others - crossing))]
            return float(np.abs(nearest) - STABLE) if nearest.imag > _COMPLEX else np.nan

        ends = measure(base), measure(after)
        if not ends[0] * ends[1] < 0.0:
            return None
        return self._locate(base, size, measure, after=after, kind="torus")

    def _finish_range(self, point: CyclePoint) -> None:
        """Add the orbit on the edge of the range and end the branch."""
        edge = min(max(point.orbit.parameter, self.limits.low), self.limits.high)
        before = self.branch.points[-1]
        reach = point.orbit.parameter - before.orbit.parameter
        if abs(edge - before.orbit.parameter) > 1e-9 * abs(reach):
            near = min((before, point), key=lambda p: abs(p.orbit.parameter - edge))
            try:
                self._add(cycle_beside(self.model, near, edge))
            except NumericalError as error:
                self.branch.remarks.append(
                    f"no cycle is found at {self.model.parameter} = {edge:.6g}, where the range "
                    f"ends ({error}); the last one told is at {before.orbit.parameter:.6g}"
                )
        self._end("range", f"{self.model.parameter} reaches {edge:.6g}")

    @property
    def _parameter_scale(self) -> float:
        return 0.2 * (self.limits.high - self.limits.low)

    def _scales(self, orbit: Orbit) -> Scales:
        return Scales(orbit.scales(), orbit.period, self._parameter_scale)

    def _add(self, point: CyclePoint) -> None:
        self.branch.points.append(point)
        self.told(point)

    def _end(self, ending: str, reason: str) -> None:
        self.branch.ending, self.branch.reason = ending, reason


def _free(scales: Scales, along: Direction | None) -> float | None:
    """Return the size of changes of the parameter, None where it is held."""
    return None if along is None else scales.parameter


def _passes_one(before: CyclePoint, after: CyclePoint) -> bool:
    """Return whether a multiplier may pass 1 between two points, as at a branch point."""
    return bool(min(np.abs(p.multipliers.others - 1.0).min() for p in (before, after)) < _NEAR_ONE)


def _slope(point: CyclePoint) -> float:
    return float(point.tangent.parameter)


_MEASURES: dict[str, Callable[[CyclePoint], float]] = {
    "fold": _slope,
    "branch_point": lambda point: point.multipliers.test_branch,
    "period_doubling": lambda point: point.multipliers.test_doubling,
}
