"""Follow periodic orbits along a parameter, through folds, and find where they change.

References
----------
Keller (1977), Numerical solution of bifurcation and nonlinear eigenvalue problems: pseudo-
arclength continuation. Seydel (2010), Practical Bifurcation and Stability Analysis, 3rd ed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.collocation import Direction, dot
from vehicledyn.analyse.periodic.cycle_points import (
    Branch,
    CyclePoint,
    Limits,
    between,
    cosine,
    moved,
)
from vehicledyn.analyse.periodic.cycles_at import cycle_beside
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.analyse.periodic.orbit_steps import BranchSteps
from vehicledyn.analyse.periodic.outside_range import RangeExcursion
from vehicledyn.analyse.periodic.special_points import SpecialPoints
from vehicledyn.base.errors import NumericalError

Report = Callable[["CyclePoint"], None]

_SMALLEST, _FIRST, _LARGEST = 1e-7, 0.05, 0.4
_SHARP, _TO_AND_FRO, _SHARPLY = math.pi / 3.0, math.pi / 4.0, 2e-3
"""Largest turn of the direction in a step, and largest angle by which its chord may turn more
[rad]; steps from which on they count."""

_ASIDE = 4.0
"""Distance of a point, part of the step, from which on it is none of the same leg: on an arc that
turns by less than the angle above it is half as far."""

_EASY, _HARD = 4, 7
_CHORD = 7, 11
"""Iterations of a step that may grow and of one that must shrink, with derivatives kept."""

_SHRUNK = 0.5
_GROWN, _UNMOVED = 1e6, 1e-9
"""Growth of a cycle while the parameter moves by less than a part of its range: it is linear."""


def follow_cycles(
    model: AutonomousField,
    start: Orbit,
    direction: Direction | None,
    limits: Limits,
    *,
    branch: Branch | None = None,
    report: Report | None = None,
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
    report
        Called with each point.

    Raises
    ------
    NumericalError
        If not even the first orbit is found. A branch that is lost later says so in its ending.
    """
    result = Branch() if branch is None else branch
    steps = BranchSteps(model, limits, start.intervals)
    special = SpecialPoints(steps, result.remarks)
    tracer = _Tracer(steps, special, result, report or (lambda point: None))
    tracer.begin(start, direction, upwards=upwards)
    tracer.run()
    return result


@dataclass
class _Tracer:
    """A branch while it is followed."""

    steps: BranchSteps
    special: SpecialPoints
    branch: Branch
    report: Report
    step: float = _FIRST
    first_size: float = 0.0
    outside: RangeExcursion = field(default_factory=RangeExcursion)

    @property
    def limits(self) -> Limits:
        """Where the branch ends."""
        return self.steps.limits

    @property
    def parameter(self) -> str:
        """The name of the parameter."""
        return self.steps.model.parameter

    def begin(self, start: Orbit, direction: Direction | None, *, upwards: bool) -> None:
        """Find the first orbit."""
        if direction is None:
            point = self.steps.first_at(start, 1.0 if upwards else -1.0)
        else:
            point = self.steps.first(start, direction)
            self.first_size = float(np.ptp(start.states, axis=0).max())
        self._add(point)
        self.special.begin(point)

    def run(self) -> None:
        """Follow the branch to its end."""
        while len(self.branch.points) - self.outside.count < self.limits.points:
            base = next(p for p in reversed(self.branch.points) if not p.kind)
            point, size = self._next(base)
            if point is None:
                break
            edge = self._passed_edge(base, point)
            passes = edge is not None
            for found in self.special.along(base, point, size):
                if self._is_inside(found) or (self.limits.outer and not passes):
                    self._add(found)
            if edge is not None:
                self._add_edge(edge, point)
                if not self._is_inside(point) and self.limits.outer is None:
                    self._end("range", f"{self.parameter} reaches {edge:.6g}")
                    break
                self.outside.pass_edge(edge)
            if not self._is_inside(point):
                if not self.outside.edges:  # its first cycle lay outside, by rounding
                    self.outside.pass_edge(self._nearest_inside(point))
                if self.outside.ends_before(point, self.limits):
                    self._end("range", f"{self.parameter} reaches {self.outside.edges[-1]:.6g}")
                    break
                self.outside.count += 1
            self._add(point)
            if np.ptp(point.orbit.states, axis=0).max() < _SHRUNK * self.first_size:
                self._end("equilibrium", "the cycle shrinks to an equilibrium")
                break
            if self._is_linear(point):
                self._end("linear", "cycles of any amplitude stand at one value")
                self.branch.remarks.append(
                    f"cycles of any amplitude stand at {self.parameter} = "
                    f"{point.orbit.parameter:.6g}: the motion is linear, nothing bounds it beyond "
                    "and none of them is a limit cycle"
                )
                break
        else:
            self._end("points", f"{self.limits.points} points are found")
        self._tell_outside()

    def _is_linear(self, point: CyclePoint) -> bool:
        """Return whether cycles have grown out of all measure at one value of the parameter."""
        size = float(np.ptp(point.orbit.states, axis=0).max())
        if not 0.0 < _GROWN * self.first_size < size:
            return False
        way = abs(point.orbit.parameter - self.branch.points[0].orbit.parameter)
        return way <= _UNMOVED * (self.limits.high - self.limits.low)

    def _passed_edge(self, base: CyclePoint, point: CyclePoint) -> float | None:
        """Return the end of the range that lies between two points, None where there is none."""
        if self._is_inside(base) is self._is_inside(point):
            return None
        beyond = base if self._is_inside(point) else point
        return self._nearest_inside(beyond)

    def _nearest_inside(self, point: CyclePoint) -> float:
        """Return the value of the range that is nearest to the one of a point."""
        return min(max(point.orbit.parameter, self.limits.low), self.limits.high)

    def _tell_outside(self) -> None:
        """Say where the branch was outside the range; leave out what does not lead back."""
        tail = self.branch.drop_tail(self.limits)
        remark = self.outside.remark(self.parameter, tail, self.branch, self.limits)
        if remark:
            self.branch.remarks.append(remark)
        if tail and self.branch.ending in ("lost", "equilibrium"):
            edge = self.outside.edges[-1]
            self._end("range", f"{self.parameter} reaches {edge:.6g}")

    def _next(self, base: CyclePoint) -> tuple[CyclePoint | None, float]:
        """Return the next point and the step to it; None where the branch is lost."""
        why = ""
        while self.step > _SMALLEST:
            size = self._limited(base)
            try:
                point = self.steps.ahead_of(base, size)
            except NumericalError as error:
                why, self.step = str(error), 0.4 * size
                behind = self.steps.behind_corner_of(base, size)
                if behind is None:
                    continue
                point, self.step = behind
                return point, size
            if size > _SHARPLY and (self._is_far(base, point, size) or self._is_sharp(base, point)):
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
        self._end("lost", f"lost near {self.parameter} = {value:.6g}: {why}")
        return None, 0.0

    def _limited(self, base: CyclePoint) -> float:
        slope = abs(base.tangent.parameter)
        inside = self._is_inside(base)
        widest = self.limits.parameter_step if inside else self.limits.step_outside
        largest = widest / slope if slope else np.inf
        return float(min(self.step, largest))

    def _is_far(self, before: CyclePoint, after: CyclePoint, size: float) -> bool:
        """Return whether a point is so far beside a step that it lies on another leg."""
        orbit = before.orbit
        chord = between(orbit, after.orbit.moved(orbit.mesh))
        return bool(dot(orbit, chord, chord, self.steps.scales(orbit)) > (_ASIDE * size) ** 2)

    def _is_sharp(self, before: CyclePoint, after: CyclePoint) -> bool:
        """Return whether the branch may do more between two points than turn smoothly.

        A smooth arc turns by the angles of its chord with both directions; where these are much
        more, the branch may turn to and fro between.
        """
        orbit, scales = after.orbit, self.steps.scales(after.orbit)
        first = moved(before.orbit, before.tangent, orbit.mesh)
        chord = between(before.orbit.moved(orbit.mesh), orbit)
        pairs = ((first, after.tangent), (first, chord), (chord, after.tangent))
        turn, *ends = (
            math.acos(np.clip(cosine(orbit, *pair, scales), -1.0, 1.0)) for pair in pairs
        )
        return bool(turn > _SHARP or sum(ends) - turn > _TO_AND_FRO)

    def _add_edge(self, edge: float, point: CyclePoint) -> None:
        """Add the orbit on the edge of the range, between the last point and the next."""
        before = self.branch.points[-1]
        reach = point.orbit.parameter - before.orbit.parameter
        if abs(edge - before.orbit.parameter) <= 1e-9 * abs(reach):
            return
        near = min((before, point), key=lambda p: abs(p.orbit.parameter - edge))
        try:
            self._add(cycle_beside(self.steps.model, near, edge))
        except NumericalError as error:
            self.branch.remarks.append(
                f"no cycle is found at {self.parameter} = {edge:.6g}, where the range "
                f"ends ({error}); the last one found is at {before.orbit.parameter:.6g}"
            )

    def _is_inside(self, point: CyclePoint) -> bool:
        return self.limits.holds(point.orbit.parameter)

    def _add(self, point: CyclePoint) -> None:
        self.branch.points.append(point)
        self.report(point)

    def _end(self, ending: str, reason: str) -> None:
        self.branch.ending, self.branch.reason = ending, reason
