"""Slides along an axis of the frame."""

from __future__ import annotations

from typing import ClassVar

from vehicledyn.base.registry import register
from vehicledyn.multibody.joints.joint_type import Axes, JointType
from vehicledyn.symbolic import rotations
from vehicledyn.symbolic.ops import Scalar, Vec


class Slide(JointType):
    """Slide by q along an axis, d = q e."""

    unit = "m"
    slides_along: ClassVar[int]

    def displacement(self, q: Scalar) -> Vec:
        """Return q e [m]."""
        return rotations.axis_vector(self.slides_along) * q

    def motion(self, q: Scalar) -> Axes:
        """Return e as linear axis."""
        return Axes(linear=rotations.axis_vector(self.slides_along))

    def is_turned_by_mirror(self, axis: int) -> bool:
        """Return whether it slides along the normal of the mirror."""
        return axis == self.slides_along


@register("joint_type", "T1")
class SlideX(Slide):
    """Slide along axis 1."""

    slides_along = 1
    usual_name = "x"


@register("joint_type", "T2")
class SlideY(Slide):
    """Slide along axis 2."""

    slides_along = 2
    usual_name = "y"


@register("joint_type", "T3")
class SlideZ(Slide):
    """Slide along axis 3."""

    slides_along = 3
    usual_name = "z"
