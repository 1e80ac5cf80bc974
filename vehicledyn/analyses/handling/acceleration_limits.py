"""g-g diagram: the largest lateral acceleration of steady turns at longitudinal accelerations.

For each longitudinal acceleration lateral acceleration grows to its limit; drive and brake torques
are those of the car's drive and of brakes with its distribution.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.handling.steady_turn import SteadyTurn, Turn
from vehicledyn.analyses.handling.tested_car import CarPoint
from vehicledyn.analyses.handling.turn_paths import TurnPath, followed

Vector = NDArray[np.float64]

_FIRST_STEP, _SMALLEST_STEP = 0.5, 0.03
_SMALLEST_ALONG = 0.1
_EVEN = 1e-9


@dataclass(frozen=True)
class AccelerationLimits:
    """Limits at a speed [m/s]: accelerations along and across the path, shape (n,) [m/s²].

    ``lost`` names what was left off before a limit showed.
    """

    speed: float
    longitudinal: Vector
    lateral: Vector
    lost: tuple[str, ...] = ()


def acceleration_limits(
    solver: SteadyTurn, speed: float, *, step: float = 1.0
) -> AccelerationLimits:
    """Return the limits for braking and driving in steps of longitudinal acceleration [m/s²].

    Raises
    ------
    NumericalError
        If the car does not run straight.
    """
    pairs, lost = [], []
    for direction, words in ((-1.0, "braking"), (1.0, "driving")):
        path = _straight(solver, speed, direction, step)
        if path.is_lost:
            lost.append(f"{words}: {_FURTHER % path.values[-1]} along the path")
        for size, point in zip(path.values, path.points, strict=True):
            along = direction * size
            if abs(size / step - round(size / step)) > _EVEN or (size == 0.0 and direction < 0.0):
                continue
            across = _across(solver, speed, along, (0.0, point))
            pairs.append((along, max(across.values)))
            if across.is_lost:
                lost.append(f"{words} at {size:g} m/s^2: {_FURTHER % across.values[-1]} across it")
    pairs.sort()
    return AccelerationLimits(
        speed,
        np.array([along for along, _ in pairs]),
        np.array([lateral for _, lateral in pairs]),
        tuple(lost),
    )


_FURTHER = "no balance was found beyond %.3g m/s^2"


def _straight(solver: SteadyTurn, speed: float, direction: float, step: float) -> TurnPath:
    def turn(size: float) -> Turn:
        return Turn(speed, "lateral_acceleration", 0.0, direction * size)

    begin = 0.0, solver.find(turn(0.0), solver.straight(speed))
    return followed(solver, turn, begin, np.inf, step=step, smallest=_SMALLEST_ALONG)


def _across(
    solver: SteadyTurn, speed: float, along: float, start: tuple[float, CarPoint]
) -> TurnPath:
    def turn(lateral: float) -> Turn:
        return Turn(speed, "lateral_acceleration", lateral, along)

    return followed(solver, turn, start, np.inf, step=_FIRST_STEP, smallest=_SMALLEST_STEP)
