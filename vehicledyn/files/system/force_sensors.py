"""Sensors of system files that show forces: of joints, of cuts and of constraints."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from pydantic import Field, field_validator

from vehicledyn import multibody
from vehicledyn.base.parameters import ParameterSet
from vehicledyn.base.registry import register
from vehicledyn.files.expressions.expressions import origin
from vehicledyn.files.expressions.fields import Vector, measured, reference
from vehicledyn.files.system.laws import Values
from vehicledyn.files.system.places import Place
from vehicledyn.files.system.sensors import AllCoordinates, SensorSet
from vehicledyn.multibody.model.ground import GROUND

if TYPE_CHECKING:
    from vehicledyn.multibody.model.parts import Part

Axes = Literal["world", "body", "parent"]
Shows = tuple[Literal["force", "torque"], ...]


class _ForceSensorSet(SensorSet):
    """Base of the sensors of a force and a torque on a body."""

    body: str = reference("body", "The body that they act on")
    axes: Axes = Field(default="world", description="Axes that they are given in")
    shows: Shows = Field(default=("force", "torque"), description="What it shows")

    @field_validator("body")
    @classmethod
    def _no_ground(cls, value: str) -> str:
        if value == GROUND:
            raise ValueError("the ground needs no force to stay; name another body")
        return value


@register("sensor", "reaction")
class ReactionSet(_ForceSensorSet):
    """Force and torque that the parent of a body exerts on it through the joints between them."""

    point: Vector | None = measured(
        "m",
        "Point that the torque is about; without it the origin of the body, or where its joints "
        "start on the parent",
        default=None,
        nature="polar",
    )
    of: Literal["body", "parent"] = Field(
        default="body", description="Whose point it is and in whose axes it is given"
    )

    def sensor(self, name: str, value: Values, coordinates: AllCoordinates) -> Part:
        """Return the sensor."""
        point = None if self.point is None else value(self.point)
        return multibody.ReactionSensor(name, self.body, point, self.of, self.axes, self.shows)


@register("sensor", "constraint_force")
class ConstraintForceSet(_ForceSensorSet):
    """Force and torque that a cut or constraint exerts on a body."""

    constraint: str = reference("constraint", "The cut or constraint")
    point: Vector = measured(
        "m",
        "Point that the torque is about, in the axes of the body",
        default=origin(),
        nature="polar",
    )

    def sensor(self, name: str, value: Values, coordinates: AllCoordinates) -> Part:
        """Return the sensor."""
        point = value(self.point)
        return multibody.ConstraintForceSensor(
            name, self.constraint, self.body, point, self.axes, self.shows
        )


def acted_on(item: ParameterSet) -> list[str]:
    """Return the bodies that a cut or constraint of a file acts on directly."""
    places = [getattr(item, end, None) for end in ("a", "b")]
    places += getattr(item, "points", {}).values()
    bodies = [place.body for place in places if isinstance(place, Place)]
    own = getattr(item, "body", None)
    return list(dict.fromkeys([*bodies, own] if own else bodies))
