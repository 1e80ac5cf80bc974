"""Points of a branch of periodic orbits, the branch that they make, and ways along it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from vehicledyn.analyse.periodic.collocation import Direction, Scales, dot
from vehicledyn.analyse.periodic.floquet import Multipliers, multipliers_of
from vehicledyn.analyse.periodic.monodromy import Passages
from vehicledyn.analyse.periodic.multiple_shooting import Closed, direction_of
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.kernel.engine import Vector

_SCALE, _SCALE_OUTSIDE = 0.2, 0.05
"""Parts of the range, and of that which a branch may reach, by which changes are measured."""

_WIDE, _STEPS_OUTSIDE = 2.0, 40
"""How much wider steps are outside the range, and how many lead through all that is reached."""

_STRAIGHT = 0.95
"""Cosine from which on a direction is kept though its sense changes: at a branch point."""


@dataclass(frozen=True)
class Limits:
    """Where a branch ends and how finely it is followed.

    ``low`` and ``high`` bound the parameter, ``parameter_step`` is the largest step of it,
    ``points`` the largest number of points, ``intervals`` that of mesh intervals. A branch that
    leaves the range is followed as far as ``outer``, in case it comes back; None to end it there.
    """

    low: float
    high: float
    parameter_step: float
    points: int = 400
    intervals: int = 320
    outer: tuple[float, float] | None = None

    def holds(self, value: float) -> bool:
        """Return whether the range holds a value of the parameter."""
        return self.low <= value <= self.high

    @property
    def scale(self) -> float:
        """Size with which changes of the parameter are measured, no smaller for a narrow range."""
        low, high = self.outer or (self.low, self.high)
        return max(_SCALE * (self.high - self.low), _SCALE_OUTSIDE * (high - low))

    @property
    def step_outside(self) -> float:
        """Largest step of the parameter outside the range."""
        low, high = self.outer or (self.low, self.high)
        return max(_WIDE * self.parameter_step, (high - low) / _STEPS_OUTSIDE)

    def reaches(self, value: float) -> bool:
        """Return whether a branch is followed as far as a value."""
        low, high = self.outer or (self.low, self.high)
        return low <= value <= high


@dataclass(frozen=True)
class CyclePoint:
    """A periodic orbit with its multipliers and the direction of the branch there.

    ``kind`` is "" for an ordinary point, else "fold", "period_doubling", "torus" or
    "branch_point". ``passages`` are kept where the next point is found with them, ``sense`` where
    it is known: the sign that the direction keeps round folds and corners. ``corner`` is the way
    from the point before to a corner that lies between, None where there is none.
    """

    orbit: Orbit
    multipliers: Multipliers
    tangent: Direction
    iterations: int
    kind: str = ""
    passages: Passages | None = None
    sense: float = 0.0
    corner: float | None = None

    @property
    def stable(self) -> bool:
        """Whether disturbances decay."""
        return self.multipliers.unstable == 0


@dataclass
class Branch:
    """Points in the order they were found, special ones among them, and how it ended.

    ``ending`` is "range" (the parameter left it), "equilibrium" (the orbit shrank to one),
    "linear" (cycles of any amplitude stand at one value), "points" or "lost"; ``reason`` says it
    in words. ``remarks`` name special points that are known roughly only, ways outside the range,
    and linear motions.
    """

    points: list[CyclePoint] = field(default_factory=list)
    ending: str = ""
    reason: str = ""
    remarks: list[str] = field(default_factory=list)

    @property
    def special(self) -> list[CyclePoint]:
        """Folds and bifurcations."""
        return [point for point in self.points if point.kind]

    def drop_tail(self, limits: Limits) -> list[CyclePoint]:
        """Remove the points behind the last one in a range, and return them."""
        count = len(self.points)
        while count and not limits.holds(self.points[count - 1].orbit.parameter):
            count -= 1
        tail = self.points[count:]
        del self.points[count:]
        return tail


def point_of(
    exact: Closed, before: Direction, parameter_scale: float, sense: float = 0.0
) -> CyclePoint:
    """Return the point of an orbit that integration has found.

    A direction of another ``sense`` than before is turned round, unless it is nearly that of
    ``before``: then a branch point is passed.
    """
    orbit = exact.orbit
    scales = Scales(orbit.scales(), orbit.period, parameter_scale)
    found, own = direction_of(exact, parameter_scale, before)
    found = found.times(1.0 / np.sqrt(dot(orbit, found, found, scales)))
    if sense * own < 0.0 and cosine(orbit, before, found, scales) < _STRAIGHT:
        found, own = found.times(-1.0), sense
    return CyclePoint(
        orbit,
        multipliers_of(exact.passages),
        found,
        exact.iterations,
        passages=exact.passages,
        sense=own or sense,
    )


def ahead(orbit: Orbit, along: Direction, size: float) -> Orbit:
    """Return an orbit a way along a direction."""
    return replace(
        orbit,
        states=orbit.states + size * along.states,
        period=orbit.period + size * along.period,
        parameter=orbit.parameter + size * along.parameter,
    )


def between(first: Orbit, last: Orbit) -> Direction:
    """Return the change from one orbit to another on the same mesh."""
    return Direction(
        last.states - first.states, last.period - first.period, last.parameter - first.parameter
    )


def cosine(orbit: Orbit, first: Direction, second: Direction, scales: Scales) -> float:
    """Return the cosine of the angle between two directions."""
    sizes = [dot(orbit, d, d, scales) for d in (first, second)]
    return float(dot(orbit, first, second, scales) / np.sqrt(sizes[0] * sizes[1]))


def moved(orbit: Orbit, direction: Direction, mesh: Vector) -> Direction:
    """Return a direction on another mesh."""
    states = replace(orbit, states=direction.states).moved(mesh).states
    return Direction(states, direction.period, direction.parameter)
