"""Effective wheelbase: front-wheel angle over curvature in slow turns, without slip of the axles.

An ideal car has its wheelbase. Rods of the steering, toe and camber change it by some thousandths,
which a test at constant speed takes for understeer, and one at constant radius does not.
"""

from __future__ import annotations

import numpy as np

from vehicledyn.analyses.handling.steady_turn import SteadyTurn
from vehicledyn.analyses.handling.turn_equations import Turn

_SPEEDS = (3.0, 5.0)
"""Speeds of the turns from which the angle at none follows, linear in the speed squared [m/s]."""

_CURVATURES = (0.01, 0.02)
"""Circles whose difference counts, so that what a sliding differential adds drops out [1/m]."""


def effective_wheelbase(solver: SteadyTurn) -> float:
    """Return the slope of the front-wheel angle over curvature at vanishing speed [m].

    The front-wheel angle is that of the steering wheel over the steering ratio, and the slope that
    between circles of 100 m and 50 m.

    Raises
    ------
    NumericalError
        If the car does not turn so at a walk.
    """
    angles = np.zeros((len(_SPEEDS), len(_CURVATURES)))
    for row, speed in zip(angles, _SPEEDS, strict=True):
        point = solver.straight(speed)
        for k, curvature in enumerate(_CURVATURES):
            point = solver.find(Turn(speed, "curvature", curvature), point)
            row[k] = solver.car.outputs(point)["steering_angle.angle"]
    squares = np.square(_SPEEDS)
    still = (squares[1] * angles[0] - squares[0] * angles[1]) / (squares[1] - squares[0])
    slope = (still[1] - still[0]) / (_CURVATURES[1] - _CURVATURES[0])
    return float(slope / solver.car.steering_ratio)
