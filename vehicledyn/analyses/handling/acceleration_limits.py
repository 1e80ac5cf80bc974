"""g-g diagram: the largest lateral acceleration of steady turns at longitudinal accelerations.

For each longitudinal acceleration lateral acceleration grows until no balance is found; drive and
brake torques are those of the car's drive and of brakes with its distribution.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.handling.steady_turn import SteadyTurn, Turn
from vehicledyn.analyses.handling.tested_car import CarPoint
from vehicledyn.base.errors import NumericalError

Vector = NDArray[np.float64]

_FIRST_STEP, _SMALLEST_STEP = 1.0, 0.03


@dataclass(frozen=True)
class AccelerationLimits:
    """Limits at a speed [m/s]: accelerations along and across the path, shape (n,) [m/s²]."""

    speed: float
    longitudinal: Vector
    lateral: Vector


def acceleration_limits(
    solver: SteadyTurn, speed: float, *, step: float = 1.0
) -> AccelerationLimits:
    """Return the limits for braking and driving in steps of longitudinal acceleration [m/s²].

    Raises
    ------
    NumericalError
        If the car does not run straight.
    """
    pairs = []
    for direction in (-1.0, 1.0):
        point, along = solver.straight(speed), 0.0
        while True:
            try:
                point = solver.find(Turn(speed, "lateral_acceleration", 0.0, along), point)
            except NumericalError:
                break
            if along != 0.0 or direction > 0.0:
                pairs.append((along, _limit(solver, speed, along, point)))
            along += direction * step
    pairs.sort()
    return AccelerationLimits(
        speed, np.array([along for along, _ in pairs]), np.array([lateral for _, lateral in pairs])
    )


def _limit(solver: SteadyTurn, speed: float, along: float, point: CarPoint) -> float:
    lateral, step = 0.0, _FIRST_STEP
    while step >= _SMALLEST_STEP:
        try:
            turn = Turn(speed, "lateral_acceleration", lateral + step, along)
            point = solver.find(turn, point)
        except NumericalError:
            step *= 0.5
            continue
        lateral += step
    return lateral
