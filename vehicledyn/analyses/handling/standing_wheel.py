"""Turns with one more wheel that stands, locked by its brake, near turns in which it rolls.

Newton's method for all of a turn at once leaves the kink at which friction sticks and comes back to
a wheel that rolls. So what turns and what sticks on it is balanced with the car as it is, from
friction that sticks without force, and the car with the wheel as it stands, in turns.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.newton import Evaluate, solve_damped
from vehicledyn.analyses.handling.steady_turn import BALANCED, ITERATIONS, SteadyTurn, TurnSearch
from vehicledyn.analyses.handling.tested_car import CarPoint
from vehicledyn.analyses.handling.turn_equations import TurnDemand
from vehicledyn.base.errors import NumericalError
from vehicledyn.road.vehicle import Corner

Vector = NDArray[np.float64]

_ROUNDS = 4
"""How often wheel and car take turns, behind which Newton's method finds both at once."""


def with_wheel_standing(
    solver: SteadyTurn, turn: TurnDemand, point: CarPoint, corner: Corner
) -> CarPoint:
    """Return the turn of a demand in which a wheel stands, near one in which it rolls.

    Raises
    ------
    NumericalError
        If there is none near.
    """
    return solver.find(turn, _near(solver, turn, point, corner))


def _near(solver: SteadyTurn, turn: TurnDemand, point: CarPoint, corner: Corner) -> CarPoint:
    """Return a point at which the wheel stands and the car is nearly balanced."""
    states, search = solver.states, solver.search(turn, point)
    x, spin = solver.unknowns(turn, point), solver.car.state(f"{corner.spin}_rate")
    x[states.free.index(spin)] = 0.0
    by_spin = search.evaluate(x)[1][:, states.free.index(spin)]
    held = {spin, *(k for k in states.further if by_spin[states.balanced.index(k)])}
    x[[states.free.index(k) for k in held]] = 0.0  # where friction sticks
    rolling = [*states.rolling, *states.further]
    turning = _Part(
        search,
        rows=[states.balanced.index(k) for k in rolling],
        places=[states.free.index(k) for k in rolling],
    )
    rest = _Part(
        search,
        rows=[k for k, state in enumerate([*states.balanced, -1, -1]) if state not in held],
        places=[k for k, state in enumerate([*states.free, -1, -1]) if state not in held],
    )
    for _ in range(_ROUNDS):
        x[turning.places] = turning.balanced(x, x[turning.places], corner)
        x[rest.places] = rest.balanced(x, x[rest.places], corner)
    return search.point(x)


@dataclass(frozen=True)
class _Part:
    """Some rows of a search for a turn, by as many of its unknowns."""

    search: TurnSearch
    rows: list[int]
    places: list[int]

    def balanced(self, x: Vector, start: Vector, corner: Corner) -> Vector:
        """Return the values of these unknowns that balance their rows, near a start."""
        found = solve_damped(
            self.about(x),
            start,
            tolerance=BALANCED,
            max_iterations=ITERATIONS,
            persistent=False,
        )
        if not found.solved:
            raise NumericalError(f"no turn in which {corner.name} stands is near")
        return found.point

    def about(self, x: Vector) -> Evaluate:
        """Return their residual and Jacobian as a function of these unknowns, about all."""
        whole = x.copy()

        def evaluate(part: Vector) -> tuple[Vector, Vector]:
            whole[self.places] = part
            residual, jacobian = self.search.evaluate(whole)
            return residual[self.rows], jacobian[np.ix_(self.rows, self.places)]

        return evaluate
