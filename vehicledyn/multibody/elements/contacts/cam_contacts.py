"""Cams and followers in a system: in permanent contact, compliant, or rigid with impacts.

The drawing of a cam is in the plane across an axis of its body: +Y lies along ``up``, the axis of
turning is Z. A follower is its roller's or edge's centre, or a point and the normal of its face,
whatever guides it; rollers may be bodies that turn.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np

import vehicledyn.cams.followers
import vehicledyn.cams.laws
import vehicledyn.cams.outlines  # noqa: F401
from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import register
from vehicledyn.base.shapes import Anchor, Ball, Extrusion, Shape, Wheel
from vehicledyn.cams.cam import Cam
from vehicledyn.cams.checks import checked
from vehicledyn.cams.gap import axial_gap, line_gap, point_gap
from vehicledyn.cams.opposite import OppositeCam, opposite_of
from vehicledyn.multibody.elements.contacts.contact_laws import (
    CompliantContact,
    ContactPart,
    PermanentContact,
    RigidContact,
)
from vehicledyn.multibody.elements.contacts.touch import Placing, Touch
from vehicledyn.multibody.model.declaration import ORIGIN, body_name, choice, vector
from vehicledyn.multibody.model.parts import PartEvent, Situation
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.labels import unlabelled
from vehicledyn.symbolic.ops import Scalar, Vec

_DRAWN = 180
_UP = {1: (0.0, 0.0, 1.0), 2: (0.0, 0.0, 1.0), 3: (0.0, 1.0, 0.0)}


@dataclass(frozen=True, kw_only=True)
class CamContact(ContactPart):
    """A cam that touches a follower; the base of the contacts of cams."""

    has_no_mirror_image: ClassVar[str] = "the outline of its cam is not mirrored"

    cam_body: str = body_name("Body of the cam")
    follower_body: str = body_name("Body of the follower, or of its roller")
    cam: Cam = choice("The cam and its follower, as in a file of its own")
    axis: Literal[1, 2, 3] = choice("Axis of its body that the cam turns about", default=2)
    up: Sequence[Scalar] | None = vector(
        "1",
        "Unit vector in the axes of the cam's body that +Y of the cam's drawing lies along, across "
        "the axis; z, or y where the axis is 3, if left out",
        default=None,
    )
    centre: Sequence[Scalar] = vector(
        "m", "Axis of the cam in the axes of its body", default=ORIGIN
    )
    point: Sequence[Scalar] = vector(
        "m",
        "Centre of the roller, edge, or a point of the face, in the axes of the follower's body",
        default=ORIGIN,
    )
    touches: Literal["cam", "second"] = choice(
        "Which cam of a conjugate pair the follower touches here", default="cam"
    )
    normal: Sequence[Scalar] | None = vector(
        "1",
        "Normal of a flat face away from the cam, in the axes of the follower's body",
        default=None,
    )

    def __post_init__(self) -> None:
        """Read the cam's files and refuse a cam that cannot be."""
        whole, faults = checked(self.cam, Path())
        if faults:
            place = ".".join(map(str, ("cam", *faults[0].place)))
            raise InputError(f"{place}: {faults[0].words}")
        second = opposite_of(whole)
        if self.touches == "second":
            if second is None:
                raise InputError("touches: second: the cam has no conjugate; give one in cam")
            whole = second
        object.__setattr__(self, "cam", whole)
        if (whole.touch.shape == "line") != (self.normal is not None):
            words = (
                "missing: a flat face has a normal"
                if self.normal is None
                else ("only a flat face has one; leave it out")
            )
            raise InputError(f"normal: {words}")

    @property
    def bodies(self) -> tuple[str, str]:
        """Cam and follower."""
        return self.cam_body, self.follower_body

    def touch(self, placing: Placing) -> Touch:
        """Return where the follower touches the cam."""
        turn = unlabelled(placing.rotation(self.cam_body))
        origin = unlabelled(placing.position(self.cam_body, self.centre))
        away = unlabelled(placing.position(self.follower_body, self.point)) - origin
        axes = self._axes()
        x, y, z = (ops.dot(turn @ axis, away) for axis in axes)
        gap, normal, place = self._in_cam(placing, (x, y, z), [turn @ axis for axis in axes])
        return Touch(gap, normal, origin + place)

    def shapes(self) -> tuple[Shape, ...]:
        """Return the cam, and the roller or edge."""
        at = Anchor(self.cam_body, tuple(self.centre))
        follower = self.cam.touch
        place = Anchor(self.follower_body, tuple(self.point))
        axis = tuple(1.0 if k == self.axis else 0.0 for k in (1, 2, 3))
        found: list[Shape] = []
        if follower.shape == "axial":
            return ()
        geometry = self.cam.geometry(np.linspace(0.0, 2.0 * math.pi, _DRAWN, endpoint=False))
        size = float(np.hypot(*geometry.profile).max())
        if self.axis == 2 and self.up is None:
            # x of the body is -X of the drawing where y is its Z and z its Y.
            profile = [(-float(x), float(y)) for x, y in geometry.profile.T[::-1]]
            found.append(Extrusion(self.name, at, profile, 0.4 * size, style="steel"))
        else:
            found.append(Wheel(self.name, at, axis, size, 0.4 * size, style="disc"))
        if follower.shape == "point" and follower.roller > 0.0:
            found.append(Wheel(self.name, place, axis, follower.roller, 0.3 * size, style="disc"))
        elif follower.shape == "point":
            found.append(Ball(self.name, place, 0.05 * size))
        return tuple(found)

    def _axes(self) -> tuple[Vec, Vec, Vec]:
        """Return the axes X, Y, Z of the drawing in the axes of the cam's body."""
        turns = ops.vector(*(1.0 if k == self.axis else 0.0 for k in (1, 2, 3)))
        sense = -1.0 if isinstance(self.cam, OppositeCam) and not self.cam.touch.rocks else 1.0
        up = sense * rotations.direction(self.up or _UP[self.axis])
        return ops.cross(up, turns), up, turns

    def _in_cam(
        self, placing: Placing, place: tuple[Scalar, Scalar, Scalar], axes: Sequence[Vec]
    ) -> tuple[Scalar, Vec, Vec]:
        """Return gap, normal and contact from the axis, in world axes.

        ``place`` is that of the follower's point in axes of the drawing.
        """
        x, y, z = place
        follower = self.cam.touch
        if follower.shape == "point":
            found = point_gap(self.cam, x, y)
            normal = found.normal[0] * axes[0] + found.normal[1] * axes[1]
            centre = x * axes[0] + y * axes[1] + z * axes[2]
            return found.distance, normal, centre - follower.roller * normal
        if follower.shape == "line":
            face = rotations.direction(self.normal or ORIGIN)
            given = unlabelled(placing.rotation(self.follower_body)) @ face
            nx, ny = ops.dot(axes[0], given), ops.dot(axes[1], given)
            found = line_gap(self.cam, x, y, nx, ny)
            normal = nx * axes[0] + ny * axes[1]
            along = ops.cross(axes[2], normal)
            centre = x * axes[0] + y * axes[1] + z * axes[2]
            return found.distance, normal, centre + found.along * along
        found = axial_gap(self.cam, ops.atan2(y, x) - 0.5 * math.pi, z)
        radius = ops.sqrt(x * x + y * y)
        around = (x * axes[1] - y * axes[0]) / radius
        normal = found.normal[0] * around + found.normal[1] * axes[2]
        centre = x * axes[0] + y * axes[1] + z * axes[2]
        return found.distance, normal, centre - follower.roller * normal


@register("element_type", "cam_joint")
@dataclass(frozen=True, kw_only=True)
class CamJoint(CamContact, PermanentContact):
    """A cam that its follower never leaves, as in a groove: the normal force may pull.

    The event ``pulls`` is recorded where the force falls below zero. With a conjugate cam it is no
    event: there the second cam pushes, with this force over the ratio of the levers.
    """

    def events(self, situation: Situation) -> tuple[PartEvent, ...]:
        """Return where the contact begins to pull, unless a second cam takes over."""
        return super().events(situation) if self.cam.conjugate is None else ()


@register("element_type", "cam_contact")
@dataclass(frozen=True, kw_only=True)
class CamCompliant(CamContact, CompliantContact):
    """A cam whose follower lifts off; a compliant contact with dissipation (Hunt, Crossley)."""


@register("element_type", "cam_impact")
@dataclass(frozen=True, kw_only=True)
class CamImpact(CamContact, RigidContact):
    """A cam whose follower lifts off, flies and comes back with impacts; a rigid contact."""
