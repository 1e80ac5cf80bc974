"""Point-to-point links: massless force elements between two points (book, chapter 4.3)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from vehicledyn.base.registry import register
from vehicledyn.base.shapes import Anchor, Coil, Shape
from vehicledyn.multibody.model.declaration import attachment, law, vector
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation, Wrench
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

if TYPE_CHECKING:
    from vehicledyn.multibody.model.kinematics import Kinematics

ForceLaw = Callable[[Scalar, Scalar], Scalar]
"""Force [N], positive in tension, from length [m] and its rate [m/s]."""


@dataclass(frozen=True)
class Attachment:
    """A point of a body, in the axes of the body [m]."""

    body: str
    point: Sequence[Scalar]


@register("element_type", "link")
@dataclass(frozen=True)
class PointForce(BasePart):
    """A massless force element between two points, F(Z, Ż), positive in tension.

    Without a direction the force acts along the line between the points, which must never
    coincide. With a direction, that of a slider on A which follows B sideways without friction,
    the length is direction · (point of A - point of B), measured in A, and the force on B acts
    along the direction wherever B is.
    """

    a: Attachment = attachment("One end")
    b: Attachment = attachment("The other end")
    law: ForceLaw = law("force_law", "Force, positive in tension")
    direction: Sequence[Scalar] | None = vector(
        "1",
        "Unit vector in the axes of body a; then the force acts along it and the length is "
        "measured along it from b to a",
        default=None,
    )

    def loads(self, situation: Situation) -> Loads:
        """Return the pair of opposite forces."""
        line, length, rate = self._geometry(situation)
        return Loads(wrenches=line.pair(line.direction * self.law(length, rate)))

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return length, its rate and the force."""
        _, length, rate = self._geometry(situation)
        return _link_outputs(self.name, length, rate, self.law)

    def shapes(self) -> tuple[Shape, ...]:
        """Return a spring between the points, or along the direction, where B is."""
        coil = coil_between(self.name, self.a, self.b)
        return (coil if self.direction is None else replace(coil, direction=tuple(self.direction)),)

    def _geometry(self, situation: Situation) -> tuple[LineOfAction, Scalar, Scalar]:
        kinematics = situation.kinematics
        if self.direction is None:
            line = LineOfAction.between(kinematics, self.a, self.b)
            return line, line.length, line.rate
        line = LineOfAction.along(kinematics, self.a, self.b, self.direction)
        return line, line.length, line.rate


@dataclass(frozen=True)
class LineOfAction:
    """Two points, the unit vector from A to B in the axes of the common ancestor."""

    kinematics: Kinematics
    a: Attachment
    b: Attachment
    direction: Vec
    length: Scalar
    rotation_a: Mat

    @classmethod
    def between(cls, kinematics: Kinematics, a: Attachment, b: Attachment) -> LineOfAction:
        """Return the straight line between two attachments."""
        pair = kinematics.between(a.body, b.body)
        reach = pair.position(b.body, b.point) - pair.position(a.body, a.point)
        length = ops.norm(reach)
        return cls(kinematics, a, b, reach / length, length, pair.rotation(a.body))

    @classmethod
    def along(
        cls, kinematics: Kinematics, a: Attachment, b: Attachment, direction: Sequence[Scalar]
    ) -> LineOfAction:
        """Return the line through B along a unit vector in A's axes; the length runs from B to A.

        Both forces act at B's point, so that the pair has no moment.
        """
        pair = kinematics.between(a.body, b.body)
        rotation_a = pair.rotation(a.body)
        where = pair.position(b.body, b.point) - pair.position(a.body)
        foot = rotation_a.T @ where
        axis = rotations.direction(direction)
        length = ops.dot(axis, ops.vector(*a.point) - foot)
        there = Attachment(a.body, _items(foot))
        return cls(kinematics, there, b, -(rotation_a @ axis), length, rotation_a)

    @property
    def rate(self) -> Scalar:
        """Rate of the length [m/s]."""
        return self.kinematics.time_derivative(self.length)

    def pair(self, force: Vec) -> tuple[Wrench, ...]:
        """Return ``force`` on A at its point and its opposite on B, ancestor's axes [N]."""
        pair = self.kinematics.between(self.a.body, self.b.body)
        return (
            *_wrench(self.a, self.rotation_a.T @ force),
            *_wrench(self.b, -(pair.rotation(self.b.body).T @ force)),
        )


def _wrench(end: Attachment, force: Vec) -> tuple[Wrench, ...]:
    if end.body == "ground":
        return ()
    return (Wrench(end.body, force, ops.cross(ops.vector(*end.point), force)),)


def _link_outputs(name: str, length: Scalar, rate: Scalar, law: ForceLaw) -> tuple[Output, ...]:
    return (
        Output(Channel(f"{name}.length", "m", f"Length of {name}", "link"), length),
        Output(Channel(f"{name}.rate", "m/s", f"Rate of length of {name}", "link"), rate),
        Output(
            Channel(f"{name}.force", "N", f"Force of {name}, positive in tension", "link"),
            law(length, rate),
        ),
    )


def coil_between(name: str, a: Attachment, b: Attachment) -> Coil:
    """Return the spring that is drawn between two attachments."""
    return Coil(name, Anchor(a.body, tuple(a.point)), Anchor(b.body, tuple(b.point)))


def _items(vector: Vec) -> tuple[Scalar, Scalar, Scalar]:
    return vector[0], vector[1], vector[2]
