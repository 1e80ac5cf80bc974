"""Forces of a cam at constant speed: normal force, torque, and the speed at which it lifts off."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.parameters import ParameterSet, quantity
from vehicledyn.cams.cam import Cam
from vehicledyn.cams.geometry import CamGeometry

Array = NDArray[np.float64]

_NEVER = 1e30
"""Square of a speed at which no cam turns, where contact is not lost [rad^2/s^2]."""


class CamLoad(ParameterSet):
    """What a cam moves at constant speed, and the spring that closes the contact."""

    speed: float = quantity("rad/s", "Angular velocity of the cam", gt=0.0)
    mass: float = quantity("kg", "Mass that slides", default=0.0, ge=0.0)
    stiffness: float = quantity("N/m", "Stiffness of the spring", default=0.0, ge=0.0)
    preload: float = quantity("N", "Force of the spring without lift", default=0.0)
    inertia: float = quantity("kg*m^2", "Moment of inertia that rocks", default=0.0, ge=0.0)
    turning_stiffness: float = quantity(
        "N*m/rad", "Stiffness of the spring of a rocker", default=0.0, ge=0.0
    )
    preload_torque: float = quantity("N*m", "Torque of that spring without lift", default=0.0)

    def numbers(self, *, rocks: bool) -> tuple[float, float, float]:
        """Return inertia, stiffness and preload of a follower that rocks or slides."""
        if rocks:
            return self.inertia, self.turning_stiffness, self.preload_torque
        return self.mass, self.stiffness, self.preload


class CamForces(NamedTuple):
    """Normal force [N] and torque of the cam [N m] at angles of the cam, shape (n,)."""

    normal: Array
    torque: Array


def forces_of(cam: Cam, load: CamLoad, geometry: CamGeometry) -> CamForces:
    """Return the forces without friction, m c̈ + k (c - c₀) + F₀ = lever · N."""
    needed = _needed(cam, load, geometry)
    return CamForces(needed / geometry.lever, needed * geometry.motion.slope)


def lift_off_speed(cam: Cam, load: CamLoad) -> tuple[float, float] | None:
    """Return the speed above which contact is lost [rad/s], and where; None if there is none.

    The contact is lost where the spring accelerates the follower less than the cam falls away.
    """
    from scipy.optimize import minimize_scalar

    inertia, stiffness, preload = load.numbers(rocks=cam.touch.rocks)

    def squared(theta: Array) -> Array:
        motion = cam.moving(theta)
        spring = preload + stiffness * (motion.coordinate - cam.start)
        falls = -inertia * motion.second
        found = spring / np.where(falls > 0.0, falls, 1.0)
        return np.where(falls > 0.0, np.minimum(found, _NEVER), _NEVER)

    theta = cam.samples(1440)
    values = squared(theta)
    if values.min() >= _NEVER:
        return None
    k = int(np.argmin(values))
    step = float(theta[1] - theta[0])
    refined = minimize_scalar(
        lambda x: float(squared(np.array([x]))[0]),
        bounds=(theta[k] - step, theta[k] + step),
        method="bounded",
        options={"xatol": 1e-10},
    )
    best, where = min((float(values[k]), float(theta[k])), (float(refined.fun), float(refined.x)))
    return (math.sqrt(best), where % (2.0 * math.pi)) if best > 0.0 else (0.0, where)


def _needed(cam: Cam, load: CamLoad, geometry: CamGeometry) -> Array:
    inertia, stiffness, preload = load.numbers(rocks=cam.touch.rocks)
    motion = geometry.motion
    spring = preload + stiffness * (motion.coordinate - cam.start)
    return spring + inertia * load.speed**2 * motion.second
