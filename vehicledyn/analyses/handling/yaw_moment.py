"""Yaw-moment method: lateral acceleration and yaw moment over side-slip and steering angle.

At each side-slip and steering angle the car is held at its speed with the yaw rate r = a_y/v that
its lateral acceleration belongs to, in balance but for yaw: the moment that a rig would hold it by
is that which turns it (Milliken, Milliken: Race Car Vehicle Dynamics, SAE 1995, chapter 8). At
great side-slip angles the drive may not hold the speed: the lightest driven wheel behind an open
differential reaches its largest force, or throttle to its end. There is no balance there.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.handling.acceleration_limits import ENDS, LARGEST_FORCE
from vehicledyn.analyses.handling.steady_turn import FULL_THROTTLE, WHEEL_SPIN, SteadyTurn
from vehicledyn.analyses.handling.tested_car import CarPoint
from vehicledyn.analyses.handling.turn_equations import TurnDemand
from vehicledyn.analyses.handling.turn_paths import followed, reached
from vehicledyn.base.errors import NumericalError

Vector = NDArray[np.float64]

NOT_FOUND = "not found"
"""Reason of a point whose search ended without showing why."""

REASONS = LARGEST_FORCE, WHEEL_SPIN, FULL_THROTTLE, NOT_FOUND
"""Why a point may have no balance."""

_STEP, _SMALLEST_STEP = np.radians(2.0), np.radians(0.02)
"""Longest and least steps of the side-slip angle on the way to a point [rad]."""

_STEERING_STEPS = 2


@dataclass(frozen=True)
class YawMoments:
    """The diagram at one speed [m/s].

    ``sideslip`` (n,) and ``steering`` (m,) [rad] span ``lateral_acceleration`` [m/s²] and
    ``yaw_acceleration`` [rad/s²], both (n, m); NaN where there is no balance, for which
    ``reasons`` (n, m) holds why: a wheel's largest force, wheel spin, full throttle, or that the
    search ended without showing it.
    """

    speed: float
    sideslip: Vector
    steering: Vector
    lateral_acceleration: Vector
    yaw_acceleration: Vector
    reasons: NDArray[np.str_]

    def notes(self) -> list[str]:
        """Return a sentence for each reason that leaves points without a balance."""
        lines = []
        for reason in np.unique(self.reasons[self.reasons != ""]):
            rows, _ = np.nonzero(self.reasons == reason)
            least = np.degrees(np.abs(self.sideslip[rows]).min())
            words = ENDS.get(reason, "nothing shows why")
            lines.append(
                f"{len(rows)} of {self.reasons.size} points have no balance, from {least:.3g} deg "
                f"of side-slip on: the speed is not held, {words}"
            )
        return lines


def yaw_moments(
    solver: SteadyTurn, speed: float, *, sideslip: Vector, steering: Vector
) -> YawMoments:
    """Return the diagram; angles in rad, speed in m/s."""
    shape = (len(sideslip), len(steering))
    lateral, yaw = np.full(shape, np.nan), np.full(shape, np.nan)
    reasons = np.full(shape, NOT_FOUND, dtype=object)
    straight = solver.straight(speed)
    order = np.argsort(np.abs(sideslip))
    sides = order[sideslip[order] >= 0.0], order[sideslip[order] < 0.0]
    for column, angle in enumerate(steering):
        for rows in sides:
            found, reason = held_turns(
                solver, straight, float(angle), speed=speed, to=sideslip[rows]
            )
            reasons[rows, column] = [""] * len(found) + [reason] * (len(rows) - len(found))
            for row, point in zip(rows, found, strict=False):
                lateral[row, column] = solver.car.outputs(point)["body.yaw_rate"] * speed
                yaw[row, column] = solver.yaw_acceleration(point)
    return YawMoments(speed, sideslip, steering, lateral, yaw, reasons.astype(str))


def held_turns(
    solver: SteadyTurn, straight: CarPoint, angle: float, *, speed: float, to: Vector
) -> tuple[list[CarPoint], str]:
    """Return the turns of side-slip angles that grow to one side, and why the rest has none.

    Each is followed from the one before.
    """

    def steered(value: float) -> TurnDemand:
        return TurnDemand(speed, "steering", value, sideslip=0.0)

    def turned(size: float) -> TurnDemand:
        return TurnDemand(speed, "steering", angle, sideslip=side * size)

    found: list[CarPoint] = []
    try:
        point = reached(solver, steered, angle, straight, steps=_STEERING_STEPS)
    except NumericalError:
        return found, NOT_FOUND
    side = float(np.sign(to.sum()))
    for before, after in pairwise([0.0, *np.abs(to).tolist()]):
        path = followed(
            solver,
            turned,
            (before, point),
            after,
            step=_STEP,
            smallest=_SMALLEST_STEP,
            unwanted=solver.beyond_drive,
        )
        if path.end != "found":
            return found, path.reason or (LARGEST_FORCE if path.is_limit else NOT_FOUND)
        point = path.points[-1]
        found.append(point)
    return found, ""
