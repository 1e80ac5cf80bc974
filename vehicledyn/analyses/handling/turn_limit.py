"""The limit of a curve of steady turns: where its value is largest, to rounding.

Along the curve R(ξ, λ) = 0 of turns ξ with their values λ the value stands still where the
tangent has no part of it. There a row ψ with ψ R_ξ = 0 exists, and the limit follows parameters as

    dλ/dp = -ψ R_p / (ψ R_λ).

Where the curve comes back at a corner, as where a rebound stop begins to touch, derivatives of R
jump by c g, g being those of what vanishes at the corner: it follows from the jump, and the limit
from R and it together.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from vehicledyn.analyse.newton import solve_damped
from vehicledyn.analyses.handling.steady_turn import BALANCED, ITERATIONS, LEAST_SIZE, SteadyTurn
from vehicledyn.analyses.handling.tested_car import CarPoint
from vehicledyn.analyses.handling.turn_equations import TurnOf
from vehicledyn.analyses.handling.turn_paths import TurnPath
from vehicledyn.base.errors import NumericalError

Vector = NDArray[np.float64]

_FIRST, _GROWTH, _FINER = 0.5, 1.5, 0.3
_MOST_STEPS, _MOST_FINER = 60, 8
"""First step along the curve over that of the last two turns, how steps grow, and how they shrink
where Newton's method finds no turn [1]."""

_LEVEL = 1e-5
"""Part of its value that the tangent of a curve may have where the curve comes back [1]."""

_BESIDE, _WEIGHTS = 1e-4, np.array([3.0, -3.0, 1.0])
"""Distance of turns beside a corner, in steps of the curve, and the weights of the nearest three
that give what is at the corner itself."""

_ONE = 1e-5
"""Part of the jump of derivatives at a corner that may be that of another one [1]."""

_BOTH = 1e-6
"""Ratio of singular values from which on the next to last one is zero, too [1]."""

_FURTHEST = 2.0
"""How far behind the last turn the limit may lie, in least steps of the path [1]."""


@dataclass(frozen=True)
class TurnLimit:
    """The turn of the largest value, and the row that is square to all moves of its unknowns.

    ``row`` is ψ, scaled so that ψ R_λ = 1.
    """

    value: float
    point: CarPoint
    row: Vector


@dataclass(frozen=True)
class TurnCorner:
    """The turn of the largest value at a corner, with turns just before and behind it.

    ``before`` and ``behind`` hold values, turns and derivatives of what is unbalanced by unknowns
    and value, the nearest first; ``scale`` are sizes of these.
    """

    value: float
    before: tuple[tuple[float, CarPoint, Vector], ...]
    behind: tuple[tuple[float, CarPoint, Vector], ...]
    scale: Vector

    def slopes(self, pushed: Callable[[float, CarPoint], Vector], sizes: Vector) -> Vector:
        """Return the derivatives of the value by parameters, (n_parameters,).

        Parameters
        ----------
        pushed
            Derivatives of what is unbalanced by parameters at a turn of a value.
        sizes
            Sizes of the parameters, (n_parameters,).

        Raises
        ------
        NumericalError
            If more than one corner is there.
        """
        first, second = (
            np.tensordot(
                _WEIGHTS,
                [np.hstack([rows * self.scale, pushed(v, p) * sizes]) for v, p, rows in side],
                axes=1,
            )
            for side in (self.before, self.behind)
        )
        jump, directions = np.linalg.svd(second - first)[1:]
        n = len(self.scale)
        moved = [
            -np.linalg.solve(rows[:, :n], rows[:, n:])[-1]
            for rows in (np.vstack([side, directions[0]]) for side in (first, second))
        ]
        apart = np.abs(moved[1] - moved[0]).max(initial=0.0)
        if jump[1] > _ONE * jump[0] or apart > _ONE * np.abs(moved).max(initial=0.0):
            raise NumericalError(
                f"the turns end at {self.value:.6g} where corners meet, or at one that derivatives "
                "do not show, such as where a wheel lifts; the end has no derivative"
            )
        return np.asarray(moved[0] * self.scale[-1] / sizes)


class _Curve:
    """Turns with their values along a curve, as points (ξ, λ) in the scale of a known one."""

    def __init__(self, solver: SteadyTurn, turn: TurnOf, known: tuple[float, CarPoint]) -> None:
        self._turn = turn
        self._search = solver.search(turn(known[0]), known[1])
        self.known = np.append(solver.unknowns(turn(known[0]), known[1]), known[0])
        self.scale = np.maximum(np.abs(self.known), LEAST_SIZE)

    def at(self, ahead: Vector, way: Vector) -> Vector:
        """Return the point of the curve on the plane across a way; raises NumericalError."""
        normal = way / self.scale

        def evaluate(x: Vector) -> tuple[Vector, Vector]:
            return self._search.evaluate_along(self._turn, x, normal, float(normal @ (x - ahead)))

        found = solve_damped(
            evaluate, ahead, tolerance=BALANCED, max_iterations=ITERATIONS, persistent=False
        )
        if not found.solved:
            raise NumericalError("the curve of turns is lost on the way to its limit")
        return found.point

    def before_limit(self, start: Vector, way: Vector, size: float) -> tuple[Vector, Vector, float]:
        """Return the last point before the limit, the tangent there and a step to behind it.

        Steps are shorter where the curve bends too much for them.
        """
        finer = 0
        for _ in range(_MOST_STEPS):
            try:
                x = self.at(start + size * way * self.scale, way)
            except NumericalError:
                finer += 1
                if finer > _MOST_FINER:
                    raise
                size *= _FINER
                continue
            ahead = self.tangent(x, way)
            if ahead[-1] <= 0.0:
                return start, way, size
            start, way, size = x, ahead, (_GROWTH if not finer else 1.0) * size
        raise NumericalError("the curve of turns does not come back near its last turn")

    def corner(self, x: Vector, way: Vector, size: float) -> TurnCorner:
        """Return the corner at a point, with turns in so long steps beside it."""
        sides = []
        for sign in (-1.0, 1.0):
            places = [sign * k * size * way * self.scale for k in (1, 2, 3)]
            near = [self.at(x + place, way) for place in places]
            sides.append(tuple((float(y[-1]), self.point(y), self.rows(y)) for y in near))
        return TurnCorner(float(x[-1]), sides[0], sides[1], self.scale)

    def rows(self, x: Vector) -> Vector:
        """Return the derivatives of what is unbalanced by unknowns and value."""
        normal = np.zeros(len(x))
        return self._search.evaluate_along(self._turn, x, normal, 0.0)[1][:-1]

    def tangent(self, x: Vector, way: Vector) -> Vector:
        """Return the unit tangent of the curve in its scale, within 90 deg of a way."""
        found = np.linalg.svd(self.rows(x) * self.scale)[2][-1]
        return np.asarray(found if found @ way >= 0.0 else -found)

    def point(self, x: Vector) -> CarPoint:
        """Return the turn of a point of the curve."""
        self._search.turn = self._turn(float(x[-1]))
        return self._search.point(x[:-1])


def limit_turn(
    solver: SteadyTurn,
    turn: TurnOf,
    before: tuple[float, CarPoint],
    last: tuple[float, CarPoint],
) -> TurnLimit | TurnCorner:
    """Return the limit of a curve of turns, from its last two turns with their values.

    Raises
    ------
    NumericalError
        If the curve does not come back near its last turn.
    """
    curve, x, way, size = _highest(solver, turn, before, last)
    rows = curve.rows(x)
    sides, sizes, _ = np.linalg.svd(rows[:, :-1] * curve.scale[:-1])
    if abs(curve.tangent(x, way)[-1]) > _LEVEL:
        return curve.corner(x, way, _BESIDE * size)
    if sizes[-2] <= _BOTH * sizes[-3]:
        raise NumericalError(
            f"at the limit {x[-1]:.6g} two things give way at once, such as both wheels of an "
            "axle, so that the limit has no derivative"
        )
    left = sides[:, -1]
    return TurnLimit(float(x[-1]), curve.point(x), left / float(left @ rows[:, -1]))


def limit_value(solver: SteadyTurn, turn: TurnOf, path: TurnPath, *, smallest: float) -> float:
    """Return the largest value behind the last turn of a path, to rounding.

    The limit may be a corner, as where a wheel lifts. A path ends within its least step of it; its
    last value is taken where it has no limit, or where the curve is lost behind that turn.

    Parameters
    ----------
    solver
        Finds the turns.
    turn
        The demand of a value.
    path
        Turns with their values up to the limit.
    smallest
        The least step of the path.
    """
    last = path.values[-1]
    if not path.is_limit or len(path.points) < 2:
        return last
    known = list(zip(path.values, path.points, strict=True))[-2:]
    given = known, [turn(value) for value in (known[0][0], last)], smallest

    def found() -> float:
        try:
            value = float(_highest(solver, turn, *known)[1][-1])
        except NumericalError:
            return last
        return value if last <= value <= last + _FURTHEST * smallest else last

    return solver.car.memory.recall("limit", given, found)


def _highest(
    solver: SteadyTurn,
    turn: TurnOf,
    before: tuple[float, CarPoint],
    last: tuple[float, CarPoint],
) -> tuple[_Curve, Vector, Vector, float]:
    """Return a curve, its point of the largest value, the way to there and the step along it.

    The point is smooth or a corner.
    """
    curve = _Curve(solver, turn, last)
    start, scale = curve.known, curve.scale
    earlier = np.append(solver.unknowns(turn(before[0]), before[1]), before[0])
    secant = (start - earlier) / scale
    way, size = curve.tangent(start, secant), _FIRST * float(np.linalg.norm(secant))
    if way[-1] <= 0.0:
        start, way = earlier, curve.tangent(earlier, secant)
    start, way, size = curve.before_limit(start, way, size)

    def climbing(step: float) -> float:
        if step == 0.0:
            return float(way[-1])
        return float(curve.tangent(curve.at(start + step * way * scale, way), way)[-1])

    step = brentq(climbing, 0.0, size, xtol=1e-12 * size)
    return curve, curve.at(start + step * way * scale, way), way, size
