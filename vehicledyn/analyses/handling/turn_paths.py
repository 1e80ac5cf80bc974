"""Steady turns along a quantity that grows: in steps that halve, up to a limit that is shown.

That Newton's method finds no turn is no limit yet: kinks stop it as well. At a limit the curve of
turns comes back, so the next turn along the curve itself, whatever its value, tells. Nor is every
turn that is found one before the limit: behind it the determinant of the equations has another
sign, as where a wheel slips more than at its largest force.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.handling.steady_turn import LEAST_SIZE, SteadyTurn
from vehicledyn.analyses.handling.tested_car import CarPoint
from vehicledyn.analyses.handling.turn_equations import TurnOf
from vehicledyn.base.errors import NumericalError

_FIRST_PART = 0.125
"""Part of the longest step that the first one is, before which nothing tells a leap."""

_LEAST_PART = 1.0 / 256.0
"""Least part of a first step by which a value grows."""

_LONGEST_LEAP, _SMALL_LEAP = 3.0, 0.05
"""How far a turn may lie from where the path leads, as a part of the way to there, and the part of
the size of its unknowns that is no leap. Before a limit unknowns grow like a root."""

_MOST_GROWN = 4.0
"""Most that a value grows by along the curve, in least steps; further off are other curves."""

_PARTS_AT_KINKS, _SHARE, _MOST_BENT = (0.25, 0.0625, 0.015625), 0.125, 0.5
"""Parts of the least step that pass a kink, the share of a step that shows whether turns lie on a
line behind it, and the part of the way by which they may lie off it."""

_MOST_PASSED = 40
"""Most turns along the curve behind which no step of the value leads on."""


Vector = NDArray[np.float64]
Step = Literal["found", "none", "limit", "lost", "unwanted"]
"""What a step along a path came to: a turn; none, as at a kink or behind a limit; the limit; no
turn on the curve either; or a turn that is none of those looked for."""


@dataclass(frozen=True)
class TurnPath:
    """Turns with their values, and what ended it.

    ``end`` is "found" where the wanted value was reached, "limit" where the curve comes back behind
    the last turn, "unwanted" where the turns behind it are none of those looked for, for a
    ``reason``, and "lost" where nothing shows it.
    """

    values: list[float]
    points: list[CarPoint]
    end: Step
    reason: str = ""

    @property
    def is_limit(self) -> bool:
        """Whether the curve comes back behind the last turn."""
        return self.end == "limit"

    @property
    def is_lost(self) -> bool:
        """Whether neither the wanted value nor a limit was found."""
        return self.end == "lost"


def followed(
    solver: SteadyTurn,
    turn: TurnOf,
    start: tuple[float, CarPoint],
    last: float,
    *,
    step: float,
    smallest: float,
    unwanted: Callable[[CarPoint], str] = lambda _: "",
) -> TurnPath:
    """Return turns from one that is known, in growing steps up to a value or to the limit.

    Parameters
    ----------
    solver
        Finds the turns.
    turn
        The demand of a value.
    start
        A value and its turn.
    last
        Value to end at.
    step, smallest
        Longest step of the value, and the least one; a limit is known to the latter.
    unwanted
        The reason for which the path ends before a turn; empty for a turn that is wanted.
    """
    walk = _Walk(solver, turn, start, unwanted)
    size, passed, is_growing = _FIRST_PART * step, 0, True
    while walk.values[-1] < last - 1e-9:
        came = walk.step(min(walk.values[-1] + size, last))
        if came == "found":
            size = min(2.0 * size, step) if is_growing or passed else size
            continue
        is_growing = False
        if size > smallest:
            size = max(0.5 * size, smallest)
            continue
        if came == "none":
            came = walk.pass_by(smallest) if passed < _MOST_PASSED else "lost"
            passed += 1
        if came != "found":
            return TurnPath(walk.values, walk.points, came, walk.reason)
    return TurnPath(walk.values, walk.points, "found")


class _Walk:
    """Turns found so far with their values, and steps that add to them."""

    def __init__(
        self,
        solver: SteadyTurn,
        turn: TurnOf,
        start: tuple[float, CarPoint],
        unwanted: Callable[[CarPoint], str],
    ) -> None:
        self._solver, self._turn, self._unwanted = solver, turn, unwanted
        self.values, self.points = [start[0]], [start[1]]
        self.reason = ""
        self._orientation = solver.orientation(turn(start[0]), start[1])

    def step(self, value: float) -> Step:
        """Look for the turn of a value near the last one."""
        turn = self._turn(value)
        try:
            point = self._solver.find(turn, self.points[-1])
        except NumericalError:
            return "none"
        if self._solver.orientation(turn, point) != self._orientation:
            return "limit"
        return "none" if self._leaps(value, point) else self._add(value, point)

    def pass_by(self, smallest: float) -> Step:
        """Look for a turn behind a place where a least step of the value came to none.

        The curve may have a kink there, which a short step finds: the turns behind it are as near
        as the step is short. Or it may come back, which a step along the curve itself shows.
        """
        came = self._step_past_kink(smallest)
        if came == "none":
            came = self._step_along(_MOST_GROWN * smallest)
        for part in _PARTS_AT_KINKS:
            if came == "lost":
                finer = self._step_past_kink(part * smallest)
                came = "lost" if finer == "none" else finer
        return came

    def _step_past_kink(self, size: float) -> Step:
        """Look for the turn a short step further, on a line with one on the way to it."""
        values = [self.values[-1] + share * size for share in (1.0, _SHARE)]
        try:
            points = [self._solver.find(self._turn(value), self.points[-1]) for value in values]
        except NumericalError:
            return "none"
        way, first = (self._way(v, p) for v, p in zip(values, points, strict=True))
        if np.linalg.norm(first / _SHARE - way) > _MOST_BENT * np.linalg.norm(way):
            return "none"
        is_behind = self._solver.orientation(self._turn(values[0]), points[0]) != self._orientation
        return "none" if is_behind else self._add(values[0], points[0])

    def _way(self, value: float, point: CarPoint) -> Vector:
        """Return how far the unknowns of a turn lie from those of the last one, in their sizes."""
        last, other = (
            self._solver.unknowns(self._turn(v), p)
            for v, p in ((self.values[-1], self.points[-1]), (value, point))
        )
        return np.asarray((other - last) / np.maximum(np.abs(last), LEAST_SIZE))

    def _step_along(self, most: float) -> Step:
        """Look for the next turn along the curve, where the value grows by so much at most."""
        if len(self.points) < 2:
            return "lost"
        known = [(self.values[k], self.points[k]) for k in (-2, -1)]
        beyond = self._solver.beyond(self._turn, known[0], known[1], most)
        if beyond is None:
            return "lost"
        value, point = beyond
        comes_back = self._solver.orientation(self._turn(value), point) != self._orientation
        return "limit" if comes_back or value <= self.values[-1] else self._add(value, point)

    def _add(self, value: float, point: CarPoint) -> Step:
        self.reason = self._unwanted(point)
        if self.reason:
            return "unwanted"
        self.values.append(value)
        self.points.append(point)
        return "found"

    def _leaps(self, value: float, point: CarPoint) -> bool:
        """Return whether a turn lies far from where the last two turns of the path lead."""
        values, solver, turn = self.values, self._solver, self._turn
        if len(values) < 2:
            return False
        known = [solver.unknowns(turn(values[k]), self.points[k]) for k in (-2, -1)]
        size = np.maximum(np.abs(known).max(axis=0), LEAST_SIZE)
        way = (known[1] - known[0]) * (value - values[-1]) / (values[-1] - values[-2])
        missed = (solver.unknowns(turn(value), point) - known[1] - way) / size
        most = _LONGEST_LEAP * np.linalg.norm(way / size) + _SMALL_LEAP
        return bool(np.linalg.norm(missed) > most)


def reached(
    solver: SteadyTurn, turn: TurnOf, value: float, start: CarPoint, *, steps: int
) -> CarPoint:
    """Return the turn of a value, followed from that of zero in so many steps, or in finer ones.

    Raises
    ------
    NumericalError
        If no turn of the value is found.
    """
    part, size, point = 0.0, 1.0 / steps, start
    while part < 1.0:
        wanted = min(part + size, 1.0)
        try:
            point = solver.find(turn(wanted * value), point)
        except NumericalError:
            size *= 0.5
            if size < _LEAST_PART / steps:
                raise
            continue
        part = wanted
    return point
