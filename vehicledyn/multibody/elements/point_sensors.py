"""Sensors of a point, of a turning body, and of anything that can be calculated."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

from vehicledyn.base.registry import register
from vehicledyn.multibody.model.declaration import ORIGIN, body_name, choice, vector
from vehicledyn.multibody.model.parts import BasePart, Output, Situation
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar, Vec

_AXES = ("x", "y", "z")


@register("sensor_type", "point")
@dataclass(frozen=True)
class PointSensor(BasePart):
    """Position, velocity and acceleration of a point in world axes, without gravity."""

    body: str = body_name("The body")
    point: Sequence[Scalar] = vector("m", "The point in the axes of the body", default=ORIGIN)
    shows: tuple[Literal["position", "velocity", "acceleration"], ...] = choice(
        "What it shows", default=("position", "velocity", "acceleration")
    )

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the components, named x, velocity_x, acceleration_x and so on."""
        kinematics = situation.kinematics
        found: list[Output] = []
        if "position" in self.shows:
            where = kinematics.position(self.body, self.point)
            found += self._outputs("", "m", "Position", where)
        if "velocity" in self.shows:
            velocity = kinematics.velocity(self.body, self.point)
            found += self._outputs("velocity_", "m/s", "Velocity", velocity)
        if "acceleration" in self.shows:
            acceleration = kinematics.acceleration(self.body, self.point)
            found += self._outputs("acceleration_", "m/s^2", "Acceleration", acceleration)
        return tuple(found)

    def _outputs(self, prefix: str, unit: str, word: str, vector: Vec) -> list[Output]:
        text = f"{word} of a point of {self.body}"
        return _components(f"{self.name}.{prefix}", unit, text, "world", vector)


@register("sensor_type", "rates")
@dataclass(frozen=True)
class RateSensor(BasePart):
    """Angular velocity and acceleration of a body in its own axes."""

    body: str = body_name("The body")

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the components, named angular_velocity_x and angular_acceleration_x."""
        kinematics, body = situation.kinematics, self.body
        velocity = kinematics.angular_velocity(body)
        acceleration = kinematics.angular_acceleration(body)
        head, text = f"{self.name}.angular_", f"of {body}"
        return (
            *_components(f"{head}velocity_", "rad/s", f"Angular velocity {text}", body, velocity),
            *_components(
                f"{head}acceleration_",
                "rad/s^2",
                f"Angular acceleration {text}",
                body,
                acceleration,
            ),
        )


@dataclass(frozen=True)
class ExpressionSensor(BasePart):
    """Anything that can be calculated from the motion; its channel has the sensor's name."""

    unit: str
    description: str
    law: Callable[[Situation], Scalar]

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the value."""
        channel = Channel(self.name, self.unit, self.description)
        return (Output(channel, self.law(situation)),)


def _components(head: str, unit: str, text: str, frame: str, vector: Vec) -> list[Output]:
    return [
        Output(Channel(f"{head}{axis}", unit, f"{text}, {axis}", frame), vector[k])
        for k, axis in enumerate(_AXES)
    ]
