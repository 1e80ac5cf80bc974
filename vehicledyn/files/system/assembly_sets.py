"""Sections of system files about assemblies: what a file uses, and what it asks of its user."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field, model_validator

from vehicledyn.files.expressions.fields import Scalar, SystemSet, Vector, measured, reference


class ConnectedPlace(SystemSet):
    """What stands for a connection: a body, with a point in place of 'at', or a coordinate."""

    body: str = reference("body", "The body, or ground")
    point: Vector | None = measured(
        "m",
        "Where the origin of the file lies in the axes of the body, in place of 'at'",
        default=None,
        nature="polar",
    )

    @model_validator(mode="before")
    @classmethod
    def _name_alone(cls, value: Any) -> Any:
        return {"body": value} if isinstance(value, str) else value


class AssemblyTurn(SystemSet):
    """A turn of an assembly about an axis."""

    axis: Literal[1, 2, 3] = Field(description="Axis of the turn")
    angle: Scalar = measured("rad", "Angle of the assembly, positive about the axis")


class AssemblySet(SystemSet):
    """Another system file, used as a part of this one."""

    file: str = Field(description="The system file: a path from this file, or a library name")
    at: Vector | None = measured(
        "m",
        "Where the origin of the file lies in the axes of each connected body",
        default=None,
        nature="polar",
    )
    turns: tuple[AssemblyTurn, ...] = Field(
        default=(), description="Turns of the axes of the file, after 'at', one after the other"
    )
    parameters: dict[str, Any] = Field(
        default_factory=dict,
        description="Parameters of the file with other values: quantities, or expressions of the "
        "parameters of this file",
    )
    connect: dict[str, ConnectedPlace] = Field(
        default_factory=dict,
        description="What stands for each connection of the file: a body of this one, with a "
        "point in place of 'at', or a coordinate; 'ground' is one of them",
    )
    axle: Literal["front", "rear"] | None = Field(
        default=None, description="Axle of the vehicle that all wheels of the assembly belong to"
    )


class ConnectionSet(SystemSet):
    """A body or coordinate that the user of a file has to give; the file's own stands in for it."""

    body: str | None = reference(
        "body", "Body that stands in when the file runs by itself", default=None
    )
    coordinate: str | None = reference(
        "coordinate", "Coordinate that stands in when the file runs by itself", default=None
    )
    description: str = Field(default="", description="What belongs here, for people")

    @model_validator(mode="after")
    def _one_of_both(self) -> ConnectionSet:
        if (self.body is None) == (self.coordinate is None):
            raise ValueError("give either a body or a coordinate that stands in")
        return self
