"""Yaw-moment method: lateral acceleration and yaw moment over side-slip and steering angle.

At each side-slip and steering angle the car is held at its speed with the yaw rate r = a_y/v that
its lateral acceleration belongs to, in balance but for yaw: the moment that a rig would hold it by
is that which turns it (Milliken, Milliken: Race Car Vehicle Dynamics, SAE 1995, chapter 8).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.handling.steady_turn import SteadyTurn
from vehicledyn.analyses.handling.tested_car import CarPoint
from vehicledyn.analyses.handling.turn_equations import Turn
from vehicledyn.base.errors import NumericalError

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class YawMoments:
    """The diagram at one speed [m/s].

    ``sideslip`` (n,) and ``steering`` (m,) [rad] span ``lateral_acceleration`` [m/s²] and
    ``yaw_acceleration`` [rad/s²], both (n, m); NaN where no balance was found.
    """

    speed: float
    sideslip: Vector
    steering: Vector
    lateral_acceleration: Vector
    yaw_acceleration: Vector


def yaw_moments(
    solver: SteadyTurn, speed: float, *, sideslip: Vector, steering: Vector
) -> YawMoments:
    """Return the diagram; angles in rad, speed in m/s."""
    shape = (len(sideslip), len(steering))
    lateral, yaw = np.full(shape, np.nan), np.full(shape, np.nan)
    straight = solver.straight(speed)
    order = np.argsort(np.abs(sideslip))
    for column, angle in enumerate(steering):
        known = {0.0: straight}
        for row in order:
            turn = Turn(speed, "steering", float(angle), sideslip=float(sideslip[row]))
            try:
                point = solver.find(turn, _nearest(known, float(sideslip[row])))
            except NumericalError:
                continue
            known[float(sideslip[row])] = point
            outputs = solver.car.outputs(point)
            lateral[row, column] = outputs["body.yaw_rate"] * speed
            yaw[row, column] = solver.yaw_acceleration(point)
    return YawMoments(speed, sideslip, steering, lateral, yaw)


def _nearest(known: dict[float, CarPoint], sideslip: float) -> CarPoint:
    return known[min(known, key=lambda angle: abs(angle - sideslip))]
