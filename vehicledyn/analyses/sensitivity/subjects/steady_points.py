"""Derivatives of points of the yaw-moment diagram and of the limits of acceleration."""

from __future__ import annotations

import numpy as np

from vehicledyn.analyses.handling.acceleration_limits import SMALLEST_STEP, turns_to_limits
from vehicledyn.analyses.handling.circle import QUANTITIES
from vehicledyn.analyses.handling.tested_car import CarPoint
from vehicledyn.analyses.handling.turn_equations import TurnDemand, TurnOf
from vehicledyn.analyses.handling.turn_limit import TurnCorner, TurnLimit, limit_turn
from vehicledyn.analyses.handling.turn_paths import TurnPath
from vehicledyn.analyses.handling.turn_slopes import TurnSlopes
from vehicledyn.analyses.handling.yaw_moment import held_turns
from vehicledyn.analyses.sensitivity.subjects.steady_curves import Found
from vehicledyn.analyses.sensitivity.subjects.steady_names import (
    BRAKING,
    YAW_ACCELERATION,
    Asked,
)
from vehicledyn.base.errors import NumericalError
from vehicledyn.results.store.linear_file import Quantity

_MOST_BEYOND = 2.0
"""Steps between the last turn of a path and its limit."""

_YAW = "rad/s^2", "Yaw acceleration if it were let go"


def yaw_moment_figures(slopes: TurnSlopes, asked: Asked) -> Found:
    """Yield quantities of cars that are held at side-slip angles.

    Raises
    ------
    NumericalError
        If one has no balance.
    """
    solver, speed, angle = slopes.solver, asked.of("speed"), asked.of("steering")
    straight = solver.straight(speed)
    found: dict[float, CarPoint] = {}
    for side in (1.0, -1.0):
        values = sorted({abs(v) for v in asked.values if (v >= 0.0) == (side > 0.0)})
        wanted = side * np.array(values)
        points, reason = held_turns(solver, straight, angle, speed=speed, to=wanted)
        if len(points) < len(values):
            raise NumericalError(
                f"no balance at {np.degrees(wanted[len(points)]):.4g} deg of side-slip angle: the "
                f"speed is not held ({reason})"
            )
        found |= dict(zip(wanted.tolist(), points, strict=True))
    for value in asked.values:
        turn = TurnDemand(speed, "steering", angle, sideslip=value)
        point = found[value]
        if asked.quantity == YAW_ACCELERATION:
            yield Quantity(asked.at(value), *_YAW), slopes.yaw_acceleration(turn, point)
        else:
            about = Quantity(asked.at(value), *QUANTITIES[asked.quantity])
            yield about, slopes.quantity(asked.quantity, turn, point)


def acceleration_limit_figures(slopes: TurnSlopes, asked: Asked) -> Found:
    """Yield largest lateral accelerations at accelerations along, or the largest one along.

    Raises
    ------
    NumericalError
        If turns end otherwise than where their curve comes back.
    """
    solver, speed = slopes.solver, asked.of("speed")
    if not asked.values:
        sign = -1.0 if asked.quantity == BRAKING else 1.0
        _, path = turns_to_limits(solver, speed, sign)

        def along(size: float) -> TurnDemand:
            return TurnDemand(speed, "lateral_acceleration", 0.0, sign * size)

        words = f"Largest acceleration along the path, {asked.quantity}"
        about = Quantity(f"{asked.quantity}, {asked.where}", "m/s^2", words)
        yield about, slopes.limit(along, _limit(slopes, along, path, asked.quantity))
        return
    paths: dict[float, TurnPath] = {}
    for sign in (-1.0, 1.0):
        also = sorted({abs(v) for v in asked.values if (v >= 0.0) == (sign > 0.0)})
        if also:
            turns, _ = turns_to_limits(solver, speed, sign, also=also, last=also[-1])
            paths |= {sign * size: path for size, path in turns.items()}
    for value in asked.values:

        def across(lateral: float, value: float = value) -> TurnDemand:
            return TurnDemand(speed, "lateral_acceleration", lateral, value)

        if value not in paths:
            raise NumericalError(f"the car does not reach {value:g} m/s^2 straight ahead")
        about = Quantity(asked.at(value), "m/s^2", "Largest lateral acceleration")
        limit = _limit(slopes, across, paths[value], f"at {value:g} m/s^2 along the path")
        yield about, slopes.limit(across, limit)


def _limit(slopes: TurnSlopes, turn: TurnOf, path: TurnPath, words: str) -> TurnLimit | TurnCorner:
    """Return the turn behind a path at which its curve comes back."""
    solver = slopes.solver
    if not path.is_limit:
        why = path.reason or "no turn was found on the way"
        raise NumericalError(
            f"{words}: the turns end before their curve comes back ({why}), so that the end has "
            "no derivative"
        )
    last = path.values[-1], path.points[-1]
    if len(path.values) > 1:
        before = path.values[-2], path.points[-2]
    else:
        below = last[0] - SMALLEST_STEP
        before = below, solver.find(turn(below), last[1])
    found = limit_turn(solver, turn, before, last)
    if found.value - last[0] > _MOST_BEYOND * SMALLEST_STEP:
        raise NumericalError(
            f"{words}: the turns end at a corner, such as where a wheel lifts or locks, so that "
            "the end has no derivative"
        )
    return found
