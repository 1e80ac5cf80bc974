"""Effective wheelbase: front-wheel angle over curvature in slow turns, without slip of the axles.

An ideal car has its wheelbase. Rods of the steering, toe and camber change it by some thousandths,
which a test at constant speed takes for understeer, and one at constant radius does not.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.handling.steady_turn import SteadyTurn
from vehicledyn.analyses.handling.tested_car import CarPoint
from vehicledyn.analyses.handling.turn_equations import TurnDemand

Array = NDArray[np.float64]

_SPEEDS = (3.0, 5.0)
"""Speeds of the turns from which the angle at none follows, linear in the speed squared [m/s]."""

_CURVATURES = (0.01, 0.02)
"""Circles whose difference counts, so that what a sliding differential adds drops out [1/m]."""


def slow_turns(solver: SteadyTurn) -> list[tuple[TurnDemand, CarPoint]]:
    """Return the turns that the effective wheelbase follows from, at each speed both circles.

    Raises
    ------
    NumericalError
        If the car does not turn so at a walk.
    """
    found = []
    for speed in _SPEEDS:
        point = solver.straight(speed)
        for curvature in _CURVATURES:
            turn = TurnDemand(speed, "curvature", curvature)
            point = solver.find(turn, point)
            found.append((turn, point))
    return found


def slope_at_rest(angles: Array) -> Array:
    """Return the slope of steering angles over curvature at vanishing speed, linear in them.

    Parameters
    ----------
    angles
        Of the turns of :func:`slow_turns`, shape (n_turns, ...) [rad].
    """
    by_speed = np.reshape(angles, (len(_SPEEDS), len(_CURVATURES), *np.shape(angles)[1:]))
    squares = np.square(_SPEEDS)
    still = (squares[1] * by_speed[0] - squares[0] * by_speed[1]) / (squares[1] - squares[0])
    return np.asarray((still[1] - still[0]) / (_CURVATURES[1] - _CURVATURES[0]))


def effective_wheelbase(solver: SteadyTurn) -> float:
    """Return the slope of the front-wheel angle over curvature at vanishing speed [m].

    The front-wheel angle is that of the steering wheel over the steering ratio, and the slope that
    between circles of 100 m and 50 m. Raises NumericalError as :func:`slow_turns`.
    """
    outputs = [solver.car.outputs(point) for _, point in slow_turns(solver)]
    angles = np.array([item["steering_angle.angle"] for item in outputs])
    return float(slope_at_rest(angles) / solver.car.steering_ratio)
