"""What a part of a system looks like: plain shapes on bodies, for pictures of a motion.

Points are in the axes of their body from its origin, those of "ground" in world axes; lengths
in metres. Numbers may be symbols of parameters while a system is built; they become numbers
before the shapes reach a file. A size that is None is chosen to suit the system.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, ClassVar

Point = Sequence[Any]
"""Three coordinates [m]."""


@dataclass(frozen=True)
class Anchor:
    """A point of a body."""

    body: str
    point: Point = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Shape:
    """Base of all shapes; ``name`` says what it stands for, such as a part."""

    kind: ClassVar[str] = ""

    name: str


@dataclass(frozen=True)
class Box(Shape):
    """A box of edges ``size``, turned by ``rotation`` (rows, v_body = R v_box).

    ``style`` is "body", "glass" to see through, or "steel".
    """

    kind: ClassVar[str] = "box"

    at: Anchor
    size: Point
    rotation: Sequence[Point] | None = None
    style: str = "body"


@dataclass(frozen=True)
class Extrusion(Shape):
    """A profile in the plane of x and z, drawn along y over a ``width`` about the point ``at``.

    ``profile`` are its corners (x, z) from that point, round it once. ``style`` as for a box.
    """

    kind: ClassVar[str] = "extrusion"

    at: Anchor
    profile: Sequence[Sequence[Any]]
    width: Any
    style: str = "body"


@dataclass(frozen=True)
class Ball(Shape):
    """A ball, such as a ball joint."""

    kind: ClassVar[str] = "ball"

    at: Anchor
    radius: Any = None
    style: str = "joint"


@dataclass(frozen=True)
class Tube(Shape):
    """A round bar between two points of one or two bodies: an arm, rod, pin or guide."""

    kind: ClassVar[str] = "tube"

    a: Anchor
    b: Anchor
    radius: Any = None
    style: str = "arm"


@dataclass(frozen=True)
class ColouredTube(Tube):
    """A bar whose colour follows the value of a channel, ``coloured_by``, such as a stress."""

    coloured_by: str = ""


@dataclass(frozen=True)
class Coil(Shape):
    """A spring or damper between two points of two bodies.

    With a ``direction``, a unit vector of the body of ``a``, its end there slides across that
    direction to where ``b`` is, so that the spring keeps the direction.
    """

    kind: ClassVar[str] = "coil"

    a: Anchor
    b: Anchor
    radius: Any = None
    direction: Point | None = None


@dataclass(frozen=True)
class Wheel(Shape):
    """A body of revolution: ``style`` is "tyre", "rail" (flange on the inner side) or "disc".

    ``axis`` is the axis of revolution in the body, a unit vector; for a rail wheel it points
    outwards, away from the flange. ``width`` may be None. The wheel turns with its body even where
    the axes of that do not spin with it.
    """

    kind: ClassVar[str] = "wheel"

    at: Anchor
    axis: Point
    radius: Any
    width: Any = None
    style: str = "tyre"


@dataclass(frozen=True)
class Hull(Shape):
    """The body of a vehicle from its outline seen from above, shape (m, 2), in body axes.

    ``bottom`` and ``top`` are heights in body axes; None follows the inertia of the body.
    """

    kind: ClassVar[str] = "hull"

    body: str
    outline: Sequence[Sequence[Any]]
    bottom: Any = None
    top: Any = None


@dataclass(frozen=True)
class Plane(Shape):
    """Flat ground through a point, with its upward unit normal, both in world axes."""

    kind: ClassVar[str] = "plane"

    point: Point
    normal: Point = (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Force(Shape):
    """An arrow: a force whose components are channels, at a point.

    ``at`` is a point of a body, or three channels with world coordinates. ``components`` are the
    channels along x, y and z of the ``axes``, None for zero, times the ``factors``. Axes are
    "world", "body" (those of the body of ``at`` or of ``body``, which do not spin) or "contact",
    that is along the wheel, to its left and along the normal of the ground, which follows from the
    channel ``camber`` of the wheel ``body``, whose second axis is its spin axis.
    """

    kind: ClassVar[str] = "force"

    at: Anchor | Sequence[str]
    components: Sequence[str | None]
    axes: str = "world"
    body: str | None = None
    camber: str | None = None
    factors: Sequence[float] = (1.0, 1.0, 1.0)


def as_plain(item: Any) -> Any:
    """Return a shape, or anything that holds shapes, as mappings, lists and scalars."""
    if is_dataclass(item) and not isinstance(item, type):
        plain = {field.name: as_plain(getattr(item, field.name)) for field in fields(item)}
        return {"kind": item.kind, **plain} if isinstance(item, Shape) else plain
    if isinstance(item, dict):
        return {key: as_plain(value) for key, value in item.items()}
    if isinstance(item, list | tuple):
        return [as_plain(value) for value in item]
    return item
