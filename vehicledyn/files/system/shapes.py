"""Shapes of bodies in system files: what animation and pictures draw instead of bars and boxes."""

from __future__ import annotations

from abc import abstractmethod
from typing import Literal, Self

from pydantic import Field, model_validator

from vehicledyn.base.registry import register
from vehicledyn.base.shapes import Anchor, Ball, Box, Extrusion, Shape, Tube
from vehicledyn.files.expressions.expressions import origin
from vehicledyn.files.expressions.fields import (
    Moments,
    Scalar,
    SystemSet,
    Vector,
    measured,
    reference,
)
from vehicledyn.files.system.laws import Values

FEWEST_CORNERS = 3


class ShapeSet(SystemSet):
    """Base of the shapes: each is fixed to a body, whose usual picture it replaces."""

    body: str = reference("body", "The body it is fixed to")

    @abstractmethod
    def shape(self, name: str, value: Values) -> Shape:
        """Return the shape; ``value`` returns what an expression is worth."""

    def mirrored(self, axis: int) -> Self:
        """Return the mirror image across an axis of the body; places are mirrored already."""
        return self


@register("shape", "box")
class BoxSet(ShapeSet):
    """A box with edges along the axes of the body."""

    at: Vector = measured("m", "Its middle", default=origin(), nature="polar")
    size: Vector = measured("m", "Its edges along x, y and z", nature="diagonal")
    style: Literal["body", "glass", "steel"] = Field(
        default="body", description="Colour of the body, transparent, or bare steel"
    )

    def shape(self, name: str, value: Values) -> Shape:
        """Return the box."""
        return Box(name, Anchor(self.body, value(self.at)), value(self.size), None, self.style)


@register("shape", "cylinder")
class CylinderSet(ShapeSet):
    """A round bar or shaft between two points of the body."""

    a: Vector = measured("m", "One end, in the axes of the body", nature="polar")
    b: Vector = measured("m", "The other end, in the axes of the body", nature="polar")
    radius: Scalar = measured("m", "Radius", above=0.0)
    style: Literal["arm", "rod", "pin", "guide", "steel", "rubber"] = Field(
        default="arm", description="Colour of the body (arm), or of a part of machines"
    )

    def shape(self, name: str, value: Values) -> Shape:
        """Return the cylinder."""
        first, last = (Anchor(self.body, value(end)) for end in (self.a, self.b))
        return Tube(name, first, last, value(self.radius), self.style)


@register("shape", "sphere")
class SphereSet(ShapeSet):
    """A ball."""

    at: Vector = measured("m", "Its middle", default=origin(), nature="polar")
    radius: Scalar = measured("m", "Radius", above=0.0)
    style: Literal["body", "joint", "steel", "rubber"] = Field(
        default="body", description="Colour of the body, or of a part of machines"
    )

    def shape(self, name: str, value: Values) -> Shape:
        """Return the ball."""
        return Ball(name, Anchor(self.body, value(self.at)), value(self.radius), self.style)


@register("shape", "extrusion")
class ExtrusionSet(ShapeSet):
    """A side view drawn across the width: a car body, a frame, a bracket."""

    at: Vector = measured("m", "Origin of the profile, mid-width", default=origin(), nature="polar")
    x: Moments = measured("m", "Corners of the profile, along x, round it once")
    z: Moments = measured("m", "The same corners, along z")
    width: Scalar = measured("m", "Width along y", above=0.0)
    style: Literal["body", "glass", "steel"] = Field(
        default="body", description="Colour of the body, transparent, or bare steel"
    )

    @model_validator(mode="after")
    def _has_corners(self) -> Self:
        counts = len(self.x), len(self.z)
        if counts[0] != counts[1]:
            raise ValueError(f"x has {counts[0]} corners and z {counts[1]}; give both of each")
        if counts[0] < FEWEST_CORNERS:
            raise ValueError(f"a profile has {FEWEST_CORNERS} corners or more, not {counts[0]}")
        return self

    def shape(self, name: str, value: Values) -> Shape:
        """Return the extrusion."""
        corners = tuple((value(x), value(z)) for x, z in zip(self.x, self.z, strict=True))
        at = Anchor(self.body, value(self.at))
        return Extrusion(name, at, corners, value(self.width), self.style)

    def mirrored(self, axis: int) -> Self:
        """Return the image: its profile is turned round along x or z."""
        field = {1: "x", 3: "z"}.get(axis)
        if field is None:
            return self
        corners = tuple(corner.negated() for corner in getattr(self, field))
        return self.model_copy(update={field: corners})
