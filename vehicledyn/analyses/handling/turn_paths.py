"""Steady turns along a quantity that grows: in steps that halve, up to a limit that is shown.

That Newton's method finds no turn is no limit yet: kinks stop it as well. At a limit the curve of
turns comes back, so the next turn along the curve itself, whatever its value, tells. Nor is every
turn that is found one before the limit: behind it the determinant of the equations has another
sign, as where a wheel slips more than at its largest force.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vehicledyn.analyses.handling.steady_turn import LEAST_SIZE, SteadyTurn
from vehicledyn.analyses.handling.tested_car import CarPoint
from vehicledyn.analyses.handling.turn_equations import Turn, TurnOf
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

_MOST_PASSED = 40
"""Most turns along the curve behind which no step of the value leads on."""


@dataclass(frozen=True)
class TurnPath:
    """Turns with their values, and whether the curve comes back behind the last of them.

    ``is_limit`` is False where the wanted value was reached, and where nothing tells a limit.
    ``is_lost`` says that neither the wanted value nor a limit was found.
    """

    values: list[float]
    points: list[CarPoint]
    is_limit: bool
    is_lost: bool


def followed(
    solver: SteadyTurn,
    turn: TurnOf,
    start: tuple[float, CarPoint],
    last: float,
    *,
    step: float,
    smallest: float,
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
    """
    values, points = [start[0]], [start[1]]
    size, passed, is_growing = _FIRST_PART * step, 0, True
    orientation = solver.orientation(turn(start[0]), start[1])
    while values[-1] < last - 1e-9:
        wanted = min(values[-1] + size, last)
        point, is_behind = _next(solver, turn(wanted), points[-1], orientation)
        if point is not None and _leaps(solver, turn, (values, points), wanted, point):
            point = None
        if point is None:
            is_growing = False
            if size > smallest:
                size = max(0.5 * size, smallest)
                continue
            if is_behind:
                return TurnPath(values, points, is_limit=True, is_lost=False)
            if len(points) < 2 or passed == _MOST_PASSED:
                return TurnPath(values, points, is_limit=False, is_lost=True)
            ends = [(values[k], points[k]) for k in (-2, -1)]
            beyond = solver.beyond(turn, ends[0], ends[1], _MOST_GROWN * smallest)
            if beyond is None:
                return TurnPath(values, points, is_limit=False, is_lost=True)
            wanted, point = beyond
            comes_back = solver.orientation(turn(wanted), point) != orientation
            if comes_back or wanted <= values[-1]:
                return TurnPath(values, points, is_limit=True, is_lost=False)
            passed += 1
        else:
            size = min(2.0 * size, step) if is_growing or passed else size
        values.append(wanted)
        points.append(point)
    return TurnPath(values, points, is_limit=False, is_lost=False)


def _next(
    solver: SteadyTurn, turn: Turn, near: CarPoint, orientation: int
) -> tuple[CarPoint | None, bool]:
    """Return the turn near another one, and whether what was found lies behind a limit instead."""
    try:
        point = solver.find(turn, near)
    except NumericalError:
        return None, False
    if solver.orientation(turn, point) != orientation:
        return None, True
    return point, False


def _leaps(
    solver: SteadyTurn,
    turn: TurnOf,
    path: tuple[list[float], list[CarPoint]],
    value: float,
    point: CarPoint,
) -> bool:
    """Return whether a turn lies far from where the last two turns of a path lead."""
    values, points = path
    if len(points) < 2:
        return False
    known = [solver.unknowns(turn(values[k]), points[k]) for k in (-2, -1)]
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
