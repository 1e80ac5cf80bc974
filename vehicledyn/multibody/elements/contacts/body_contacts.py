"""Contacts between bodies: stops, latches, balls in tubes and cages."""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import register
from vehicledyn.base.shapes import Anchor, Ball, Shape, Tube
from vehicledyn.multibody.elements.contacts.body_shapes import (
    Capsule,
    FlatPlane,
    Polygon,
    of_capsules,
    on_plane,
    on_polygon,
)
from vehicledyn.multibody.elements.contacts.contact_laws import (
    CompliantContact,
    ContactPart,
    RigidContact,
)
from vehicledyn.multibody.elements.contacts.touch import Placing, Touch
from vehicledyn.multibody.model.declaration import body_name, group
from vehicledyn.symbolic.labels import unlabelled
from vehicledyn.symbolic.ops import Vec


@dataclass(frozen=True, kw_only=True)
class BodyPair(ContactPart):
    """A plane, capsule or polygon of one body that a capsule or ball of another touches."""

    body_a: str = body_name("Body with the plane, capsule or polygon")
    body_b: str = body_name("Body with the capsule or ball")
    ball: Capsule = group("Ball or capsule of body b")
    plane: FlatPlane | None = group("Plane of body a", default=None)
    capsule: Capsule | None = group("Capsule or ball of body a", default=None)
    polygon: Polygon | None = group("Convex polygon or cage of body a, for balls", default=None)

    def __post_init__(self) -> None:
        """Refuse no shape, several shapes, and capsules against polygons.

        Raises
        ------
        InputError
            With what to give.
        """
        given = [s for s in (self.plane, self.capsule, self.polygon) if s is not None]
        if len(given) != 1:
            raise InputError("give one of plane, capsule and polygon of body a")
        if self.polygon is not None and self.ball.far_centre is not None:
            raise InputError("a polygon touches balls; leave out the far_centre of the ball")

    @property
    def bodies(self) -> tuple[str, str]:
        """First and second body."""
        return self.body_a, self.body_b

    def touch(self, placing: Placing) -> Touch:
        """Return where the bodies touch or are closest."""
        ends = _ends(placing, self.body_b, self.ball)
        if self.plane is not None:
            return on_plane(placing, self.body_a, self.plane, ends, self.ball.radius)
        if self.polygon is not None:
            return on_polygon(placing, self.body_a, self.polygon, ends[0], self.ball.radius)
        other = self.capsule or self.ball
        first = _ends(placing, self.body_a, other)
        return of_capsules(first, other.radius, ends, self.ball.radius)

    def shapes(self) -> tuple[Shape, ...]:
        """Return balls and capsules."""
        pairs = ((self.body_a, self.capsule), (self.body_b, self.ball))
        return tuple(_drawn(self.name, body, item) for body, item in pairs if item is not None)


def _ends(placing: Placing, body: str, item: Capsule) -> list[Vec]:
    points = [item.centre] if item.far_centre is None else [item.centre, item.far_centre]
    return [unlabelled(placing.position(body, point)) for point in points]


def _drawn(name: str, body: str, item: Capsule) -> Shape:
    start = Anchor(body, tuple(item.centre))
    if item.far_centre is None:
        return Ball(name, start, item.radius)
    return Tube(name, start, Anchor(body, tuple(item.far_centre)), item.radius)


@register("element_type", "body_contact")
@dataclass(frozen=True, kw_only=True)
class BodyContact(BodyPair, CompliantContact):
    """A compliant contact of two bodies with dissipation (Hunt, Crossley) and friction."""


@register("element_type", "body_impact")
@dataclass(frozen=True, kw_only=True)
class BodyImpact(BodyPair, RigidContact):
    """A rigid contact of two bodies that holds, lets go, and ends flights by impacts."""
