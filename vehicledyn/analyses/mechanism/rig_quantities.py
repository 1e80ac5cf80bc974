"""Kinematics and compliance of a wheel on the rig: what each quantity is, after SAE J670/ISO 8855.

Axes are those of the body: x forward, y to the left, z up. All slopes are by the control of the
test (travel, roll angle, steering or load) at rest, compliances included.

- Toe is positive inwards, camber positive where the top leans outwards, steer to the left.
- *Travel* is that of the contact point. *Wheel rate*: growth of the load there by the travel, body
  held, tyre left out.
- *Roll centre* above the contact point: with the velocity v of the carrier's point at the contact
  point, which lies y from the middle plane, h = y v_y / v_z in tests that lift wheels. Under side
  forces F it is that of the forces, h = -y dN/dF (N the load of the wheel, its height held):
  a side force at that height rolls nothing. For rigid links both agree, by virtual work.
- *Support angle*: inclination of v in the side view, positive where the force presses the wheel
  onto the road and so lifts the body: tan = v_x/v_z of the contact point for braking (brake on the
  carrier), tan = -v_x/v_z of the wheel centre for driving (drive on the body). The tangent times
  wheelbase over height of the centre of mass, and the axle's share of the force, is anti-dive at a
  front axle (its negative anti-lift at a rear one) and anti-squat at a driven rear axle.
- *Steering axis*: through the two points that the sensor names, else, in the test "steer", the
  instant axis about which the carrier turns while the spring or damper of the wheel that its
  travel compresses most keeps its length.
- Compliances: change of angle or place of the contact point a unit of load, height held.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.mechanism.instant_axes import STEERING, WheelColumns, axis_values

Array = NDArray[Any]


@dataclass(frozen=True)
class WheelPlace:
    """A wheel at a place of the test, and how it changes with the control.

    Attributes
    ----------
    is_left
        Which side it is on.
    values, slopes
        Channels of the wheel sensor by their last names, and ``load`` [N]; their slopes.
    turn, turn_slope
        Rotation from the carrier to the body, shape (3, 3), and its slope.
    steered
        The same wheel with slopes by the steering while its spring keeps its length.
    """

    is_left: bool
    values: Mapping[str, complex]
    slopes: Mapping[str, complex]
    turn: Array
    turn_slope: Array
    steered: WheelPlace | None = None

    def point(self, head: str) -> Array:
        """Return the wheel centre (""), or contact point ("contact_") [m]."""
        return np.array([self.values[f"{head}{axis}"] for axis in "xyz"])

    @property
    def turning(self) -> Array:
        """Angular velocity of the carrier by the control's."""
        rate = self.turn_slope @ self.turn.T
        return 0.5 * np.array(
            [rate[2, 1] - rate[1, 2], rate[0, 2] - rate[2, 0], rate[1, 0] - rate[0, 1]]
        )

    @property
    def centre_motion(self) -> Array:
        """Velocity of the wheel centre by the control's."""
        return np.array([self.slopes[axis] for axis in "xyz"])

    @property
    def contact_motion(self) -> Array:
        """Velocity of the carrier's point at the contact point by the control's."""
        arm = self.point("contact_") - self.point("")
        return self.centre_motion + np.cross(self.turning, arm)


@dataclass(frozen=True)
class RigQuantity:
    """A quantity of a wheel on the rig; ``value`` takes the :class:`WheelPlace`.

    It is analytic in the numbers of the place, so that steps into the complex plane differentiate
    it.
    """

    name: str
    unit: str
    description: str
    value: Callable[[WheelPlace], complex]


def _value(channel: str, unit: str, text: str) -> RigQuantity:
    return RigQuantity(channel, unit, text, lambda place: place.values[channel])


def _slope(name: str, channel: str, unit: str, text: str, factor: float = 1.0) -> RigQuantity:
    return RigQuantity(name, unit, text, lambda place: factor * place.slopes[channel])


def _roll_centre(place: WheelPlace) -> complex:
    v, y = place.contact_motion, place.values["contact_y"]
    return complex(np.divide(y * v[1], v[2]))


def _braking(place: WheelPlace) -> complex:
    v = place.contact_motion
    return complex(np.arctan(np.divide(v[0], v[2])))


def _driving(place: WheelPlace) -> complex:
    v = place.centre_motion
    return complex(np.arctan(np.divide(-v[0], v[2])))


def _named(name: str) -> Callable[[WheelPlace], complex]:
    """Return a quantity of the steering axis that the sensor names, not a number without one."""
    return lambda place: place.values.get(name, float("nan"))


def _instant(number: int, name: str) -> Callable[[WheelPlace], complex]:
    """Return a quantity of the named steering axis, else of the instant axis."""

    def value(place: WheelPlace) -> complex:
        if name in place.values:
            return place.values[name]
        wheel = WheelColumns("", place.is_left, (0, 1, 2), (3, 4, 5), 6, (0, 1, 2), (3, 4, 5))
        seen = np.array([*place.point(""), *place.point("contact_"), place.values["steer_angle"]])
        moving = place.steered or place
        ratios = np.array([*moving.turning, *moving.contact_motion])
        return complex(axis_values(wheel, seen, ratios)[number])

    return value


ANGLES = (
    _value("toe_angle", "rad", "Toe angle, positive inwards"),
    _value("camber", "rad", "Camber as seen from the front, positive outwards"),
    _value("inclination", "rad", "Inclination to the vertical, positive outwards"),
)
POSITION = (_value("half_track", "m", "Contact point from the middle plane"),)
LOAD = (_value("load", "N", "Vertical load of the wheel"),)
LIFTING = (
    _slope("wheel_rate", "load", "N/m", "Wheel rate"),
    RigQuantity("roll_centre_height", "m", "Roll centre above the contact point", _roll_centre),
    RigQuantity("brake_support_angle", "rad", "Support angle of braking", _braking),
    RigQuantity("drive_support_angle", "rad", "Support angle of driving", _driving),
)
TRAVEL = (
    _slope("toe_gain", "toe_angle", "rad/m", "Toe by travel (bump steer)"),
    _slope("camber_gain", "camber", "rad/m", "Camber by travel"),
    _slope("track_gain", "half_track", "1", "Half track by travel"),
    _slope("recession", "x", "1", "Wheel centre forward by travel"),
)
ROLL = (
    _slope("roll_steer", "steer_angle", "1", "Steer angle by the roll of the wheels"),
    _slope("roll_camber", "camber", "1", "Camber to the body by the roll of the wheels"),
)
NAMED_AXIS = tuple(RigQuantity(name, unit, text, _named(name)) for name, unit, text in STEERING)
AXIS = tuple(
    RigQuantity(name, unit, text, _instant(k, name))
    for k, (name, unit, text) in enumerate(STEERING)
)
STEER = (
    _value("steer_angle", "rad", "Steer angle, positive to the left"),
    _slope("steer_gain", "steer_angle", "rad/m", "Steer angle by the steering coordinate"),
)
BY_FORCE = (
    _slope("steer_compliance", "steer_angle", "rad/N", "Steer angle to the left by the force"),
    _slope("camber_compliance", "camber", "rad/N", "Camber by the force"),
)
BY_SIDE_FORCE = (
    RigQuantity(
        "lateral_compliance",
        "m/N",
        "Contact point to the left by the force",
        lambda p: complex(p.contact_motion[1]),
    ),
    RigQuantity(
        "roll_centre_height",
        "m",
        "Roll centre of the forces above the contact point",
        lambda p: -p.values["contact_y"] * p.slopes["load"],
    ),
)
BY_LONGITUDINAL_FORCE = (
    RigQuantity(
        "longitudinal_compliance",
        "m/N",
        "Contact point forward by the force",
        lambda p: complex(p.contact_motion[0]),
    ),
    _slope("centre_compliance", "x", "m/N", "Wheel centre forward by the force"),
    RigQuantity(
        "brake_support_angle",
        "rad",
        "Support angle of braking by the forces",
        lambda p: complex(np.arctan(-p.slopes["load"])),
    ),
)
BY_MOMENT = (
    _slope("steer_compliance", "steer_angle", "rad/(N*m)", "Steer angle by the moment"),
    _slope("camber_compliance", "camber", "rad/(N*m)", "Camber by the moment"),
)
