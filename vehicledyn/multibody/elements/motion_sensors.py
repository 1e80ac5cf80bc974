"""Sensors: parts that only show positions, velocities and accelerations of bodies."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal, TypeAlias

from vehicledyn.base.registry import register
from vehicledyn.multibody.model.declaration import ORIGIN, body_name, choice, vector
from vehicledyn.multibody.model.parts import BasePart, ForcesUnknownError, Output, Situation
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar

_STANDSTILL = 1e-3
"""Speed below which a side-slip angle has no meaning and is zero [m/s]."""

Sequence3: TypeAlias = tuple[Literal[1, 2, 3], Literal[1, 2, 3], Literal[1, 2, 3]]
"""Three axes in the order of turns about them."""

_WORDS = ("longitudinal", "lateral", "vertical")


@register("sensor_type", "body")
@dataclass(frozen=True)
class BodySensor(BasePart):
    """Velocity of a body's origin in its horizontal axes, its body rates and side-slip angle."""

    body: str = body_name("The body")

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return velocities along the heading, angular velocity and the side-slip angle."""
        kinematics = situation.kinematics
        velocity = kinematics.velocity(self.body)
        rotation = kinematics.rotation(self.body)
        yaw = rotations.yaw_pitch_roll(rotation)[0]
        along = rotations.turn(3, yaw).T @ velocity
        spin = rotation @ kinematics.angular_velocity(self.body)
        is_moving = along[0] * along[0] + along[1] * along[1] > _STANDSTILL**2
        slip = ops.where(is_moving, ops.atan2(along[1], along[0]), 0.0)
        return (
            self._output("forward_speed", "m/s", "Velocity along the heading", along[0]),
            self._output("lateral_speed", "m/s", "Velocity to the left of the heading", along[1]),
            self._output("yaw_rate", "rad/s", "Angular velocity about the vertical", spin[2]),
            self._output("sideslip_angle", "rad", "Angle of the velocity to the heading", slip),
        )

    def _output(self, name: str, unit: str, text: str, value: Scalar) -> Output:
        return Output(Channel(f"{self.name}.{name}", unit, text, "intermediate"), value)


@register("sensor_type", "accelerometer")
@dataclass(frozen=True)
class Accelerometer(BasePart):
    """Acceleration of a point of a body along its heading, to the left and upwards.

    The axes are the intermediate ones of ISO 8855: x in the horizontal plane along the
    heading, z vertical; gravity is not included.
    """

    body: str = body_name("The body")
    point: Sequence[Scalar] = vector("m", "The point in the axes of the body", default=ORIGIN)

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the three accelerations."""
        kinematics = situation.kinematics
        yaw = rotations.yaw_pitch_roll(kinematics.rotation(self.body))[0]
        along = rotations.turn(3, yaw).T @ kinematics.acceleration(self.body, self.point)
        return tuple(
            Output(
                Channel(
                    f"{self.name}.{word}",
                    "m/s^2",
                    f"{word.capitalize()} acceleration of {self.body}",
                    "intermediate",
                ),
                along[k],
            )
            for k, word in enumerate(_WORDS)
        )


@register("sensor_type", "floor")
@dataclass(frozen=True)
class FloorSensor(BasePart):
    """What an accelerometer on the floor of a body shows, and how fast the body rolls.

    The axes are those of the body. With a the acceleration of the point and g that of free fall
    the sensor shows a - g less |g| upwards, so that all is zero where it stands still and level;
    on a canted floor it feels a part of the weight.
    """

    is_seat: ClassVar[bool] = False

    body: str = body_name("The body")
    point: Sequence[Scalar] = vector("m", "The point in the axes of the body", default=ORIGIN)

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the three accelerations and the roll rate."""
        text = f"acceleration felt on the floor of {self.body}"
        force = _specific_force(situation, self.name, self.body, self.point, text)
        roll = Channel(f"{self.name}.roll_rate", "rad/s", f"Roll rate of {self.body}", "body")
        rate = situation.kinematics.angular_velocity(self.body)[0]
        return (*force, Output(roll, rate))


@register("sensor_type", "seat")
@dataclass(frozen=True)
class SeatSensor(BasePart):
    """What an accelerometer on a seat shows; the run's summary has its vibration by ISO 2631-1.

    Axes and values are those of a sensor of the kind "floor".
    """

    is_seat: ClassVar[bool] = True

    body: str = body_name("The body that the seat is fixed to")
    point: Sequence[Scalar] = vector("m", "The seat in the axes of the body", default=ORIGIN)

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the three accelerations."""
        text = f"acceleration felt on a seat of {self.body}"
        return _specific_force(situation, self.name, self.body, self.point, text)


def _specific_force(
    situation: Situation, name: str, body: str, point: Sequence[Scalar], text: str
) -> tuple[Output, ...]:
    """Return a - g less |g| upwards at a point, in the axes of its body [m/s²]."""
    if situation.forces is None:
        raise ForcesUnknownError(f"sensor '{name}': gravity is known to outputs only")
    kinematics, gravity = situation.kinematics, situation.forces.gravity
    to_body = kinematics.rotation(body).T
    force = to_body @ (kinematics.acceleration(body, point) - gravity)
    values = (force[0], force[1], force[2] - ops.sqrt(ops.dot(gravity, gravity)))
    return tuple(
        Output(Channel(f"{name}.{word}", "m/s^2", f"{word.capitalize()} {text}", "body"), value)
        for word, value in zip(_WORDS, values, strict=True)
    )


@register("sensor_type", "angles")
@dataclass(frozen=True)
class SequenceSensor(BasePart):
    """Orientation of a body as three Tait-Bryan angles in a given sequence of axes.

    ``sequence`` (3, 2, 1) gives yaw, pitch, roll of ISO 8855 with R = R3 R2 R1; any other
    sequence of three different axes may be asked for, such as (2, 1, 3) of the Iltis benchmark.
    """

    body: str = body_name("The body")
    sequence: Sequence3 = choice("Axes; 3 2 1 is yaw, pitch, roll", default=(3, 2, 1))

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the three angles, named roll, pitch and yaw after their axes."""
        angles = rotations.tait_bryan(situation.kinematics.rotation(self.body), self.sequence)
        words = {1: "roll", 2: "pitch", 3: "yaw"}
        order = "-".join(map(str, self.sequence))
        return tuple(
            Output(
                Channel(
                    f"{self.name}.{words[axis]}",
                    "rad",
                    f"{words[axis].capitalize()} of {self.body}, sequence {order}",
                ),
                angle,
            )
            for axis, angle in zip(self.sequence, angles, strict=True)
        )
