"""g-g diagram: the largest lateral acceleration of steady turns at longitudinal accelerations.

For each longitudinal acceleration lateral acceleration grows to its limit; drive and brake torques
are those of the car's drive and of brakes with its distribution.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.handling.steady_turn import SteadyTurn
from vehicledyn.analyses.handling.tested_car import CarPoint
from vehicledyn.analyses.handling.turn_equations import Turn
from vehicledyn.analyses.handling.turn_paths import TurnPath, followed

Vector = NDArray[np.float64]

_FIRST_STEP, _SMALLEST_STEP = 0.5, 0.03
_SMALLEST_ALONG = 0.1


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
        size, point = 0.0, solver.straight(speed)
        while True:
            along = direction * size
            if along or direction > 0.0:
                across = _across(solver, speed, along, (0.0, point))
                pairs.append((along, max(across.values)))
                if across.is_lost:
                    found = _FURTHER % across.values[-1]
                    lost.append(f"{words} at {size:g} m/s^2: {found} across the path")
            path = _straight(solver, speed, direction, (size, point), step)
            if path.is_limit or path.is_lost:
                break
            size, point = path.values[-1], path.points[-1]
        if path.is_lost:
            lost.append(f"{words}: {_FURTHER % path.values[-1]} along the path")
    pairs.sort()
    return AccelerationLimits(
        speed,
        np.array([along for along, _ in pairs]),
        np.array([lateral for _, lateral in pairs]),
        tuple(lost),
    )


_FURTHER = "no balance was found beyond %.3g m/s^2"


def _straight(
    solver: SteadyTurn, speed: float, direction: float, start: tuple[float, CarPoint], step: float
) -> TurnPath:
    def turn(size: float) -> Turn:
        return Turn(speed, "lateral_acceleration", 0.0, direction * size)

    last = start[0] + step
    return followed(solver, turn, start, last, step=step, smallest=_SMALLEST_ALONG)


def _across(
    solver: SteadyTurn, speed: float, along: float, start: tuple[float, CarPoint]
) -> TurnPath:
    def turn(lateral: float) -> Turn:
        return Turn(speed, "lateral_acceleration", lateral, along)

    return followed(solver, turn, start, np.inf, step=_FIRST_STEP, smallest=_SMALLEST_STEP)
