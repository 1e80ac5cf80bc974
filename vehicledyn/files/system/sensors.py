"""Sensors of system files."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

from pydantic import Field, field_validator

from vehicledyn import multibody
from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import register
from vehicledyn.base.units import to_si
from vehicledyn.files.expressions.expressions import origin
from vehicledyn.files.expressions.fields import Scalar, SystemSet, Vector, measured, reference
from vehicledyn.files.system.joints import Sequence as Axes
from vehicledyn.files.system.laws import Values

if TYPE_CHECKING:
    from vehicledyn.multibody.model.parts import Part, Situation

AllCoordinates = Sequence[str]
"""Names of all coordinates of a system."""


def motion_of(situation: Situation, coordinates: AllCoordinates) -> dict[str, Any]:
    """Return time, coordinates, rates and switches by the names that expressions have for them."""
    from vehicledyn.multibody.elements.triggers import switches

    names: dict[str, Any] = {"time": situation.time, **switches(situation)}
    for name in coordinates:
        names[name] = situation.kinematics.coordinate(name)
        names[f"{name}_rate"] = situation.kinematics.rate(name)
    return names


class SensorSet(SystemSet):
    """Base of the sensors."""

    @abstractmethod
    def sensor(self, name: str, value: Values, coordinates: AllCoordinates) -> Part:
        """Return the sensor of this name.

        ``value`` returns what an expression is worth; ``coordinates`` are all of the system.
        """


class _OfBody(SensorSet):
    """Base of the sensors that look at one body."""

    body: str = reference("body", "The body")


@register("sensor", "point")
class PointSensorSet(_OfBody):
    """Position, velocity and acceleration of a point in world axes."""

    point: Vector = measured(
        "m", "The point in the axes of the body", default=origin(), nature="polar"
    )
    shows: tuple[Literal["position", "velocity", "acceleration"], ...] = Field(
        default=("position", "velocity", "acceleration"), description="What it shows"
    )

    def sensor(self, name: str, value: Values, coordinates: AllCoordinates) -> Part:
        """Return the sensor."""
        from vehicledyn.multibody.elements.point_sensors import PointSensor

        return PointSensor(name, self.body, value(self.point), self.shows)


@register("sensor", "rates")
class RateSensorSet(_OfBody):
    """Angular velocity and acceleration of a body in its own axes."""

    def sensor(self, name: str, value: Values, coordinates: AllCoordinates) -> Part:
        """Return the sensor."""
        from vehicledyn.multibody.elements.point_sensors import RateSensor

        return RateSensor(name, self.body)


@register("sensor", "angles")
class AngleSensorSet(_OfBody):
    """Orientation of a body to the world as three angles in a sequence of axes."""

    sequence: Axes = Field(default=(3, 2, 1), description="Axes; 3 2 1 is yaw, pitch, roll")

    def sensor(self, name: str, value: Values, coordinates: AllCoordinates) -> Part:
        """Return the sensor."""
        return multibody.SequenceSensor(name, self.body, self.sequence)


@register("sensor", "body")
class BodySensorSet(_OfBody):
    """Forward and lateral speed, yaw rate and side-slip angle of a body."""

    def sensor(self, name: str, value: Values, coordinates: AllCoordinates) -> Part:
        """Return the sensor."""
        return multibody.BodySensor(name, self.body)


@register("sensor", "accelerometer")
class AccelerometerSet(_OfBody):
    """Acceleration of a point along the heading, to the left and upwards."""

    point: Vector = measured(
        "m", "The point in the axes of the body", default=origin(), nature="polar"
    )

    def sensor(self, name: str, value: Values, coordinates: AllCoordinates) -> Part:
        """Return the sensor."""
        return multibody.Accelerometer(name, self.body, value(self.point))


@register("sensor", "floor")
class FloorSensorSet(_OfBody):
    """What an accelerometer on the floor shows, gravity included, and the roll rate."""

    point: Vector = measured(
        "m", "The point in the axes of the body", default=origin(), nature="polar"
    )

    def sensor(self, name: str, value: Values, coordinates: AllCoordinates) -> Part:
        """Return the sensor."""
        from vehicledyn.multibody.elements.motion_sensors import FloorSensor

        return FloorSensor(name, self.body, value(self.point))


@register("sensor", "expression")
class WrittenSensor(SensorSet):
    """Any expression of coordinates, rates and time."""

    value: Scalar = measured("", "What it shows", variables="motion")
    unit: str = Field(description="SI unit of the value, such as m/s")
    description: str = Field(default="", description="What it is, for people")

    @field_validator("unit")
    @classmethod
    def _known_unit(cls, value: str) -> str:
        try:
            to_si(f"1 {value}", value)
        except InputError as error:
            raise ValueError(str(error)) from None
        return value

    def sensor(self, name: str, value: Values, coordinates: AllCoordinates) -> Part:
        """Return the sensor."""
        from vehicledyn.multibody.elements.point_sensors import ExpressionSensor

        return ExpressionSensor(
            name,
            self.unit,
            self.description or f"Expression '{name}'",
            lambda situation: value(self.value, **motion_of(situation, coordinates)),
        )
