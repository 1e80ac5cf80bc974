"""Sensors of system files that are written as expressions."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from pydantic import Field, field_validator

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import register
from vehicledyn.base.units import to_si
from vehicledyn.files.expressions.fields import Scalar, SystemSet, measured
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
    """Base of the sensors that are no classes of the catalogue."""

    @abstractmethod
    def element(self, name: str, value: Values, coordinates: AllCoordinates) -> Part:
        """Return the sensor of this name.

        ``value`` returns what an expression is worth; ``coordinates`` are all of the system.
        """


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

    def element(self, name: str, value: Values, coordinates: AllCoordinates) -> Part:
        """Return the sensor."""
        from vehicledyn.multibody.elements.point_sensors import ExpressionSensor

        return ExpressionSensor(
            name,
            self.unit,
            self.description or f"Expression '{name}'",
            lambda situation: value(self.value, **motion_of(situation, coordinates)),
        )
