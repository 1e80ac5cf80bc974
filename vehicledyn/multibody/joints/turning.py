"""Turns about an axis of the frame."""

from __future__ import annotations

from typing import ClassVar

from vehicledyn.base.registry import register
from vehicledyn.multibody.joints.joint_type import Axes, JointType
from vehicledyn.symbolic import rotations
from vehicledyn.symbolic.ops import Mat, Scalar


class TurnAbout(JointType):
    """Turn by q about an axis e."""

    unit = "rad"
    turns_about: ClassVar[int]

    def rotation(self, q: Scalar) -> Mat:
        """Return the turn by q."""
        return rotations.turn(self.turns_about, q)

    def motion(self, q: Scalar) -> Axes:
        """Return e as angular axis."""
        return Axes(angular=rotations.axis_vector(self.turns_about))

    def is_turned_by_mirror(self, axis: int) -> bool:
        """Return whether it turns about an axis in the mirror's plane."""
        return axis != self.turns_about


@register("joint_type", "R1")
class TurnX(TurnAbout):
    """Turn about axis 1."""

    turns_about = 1
    usual_name = "roll"


@register("joint_type", "R2")
class TurnY(TurnAbout):
    """Turn about axis 2."""

    turns_about = 2
    usual_name = "pitch"


@register("joint_type", "R3")
class TurnZ(TurnAbout):
    """Turn about axis 3."""

    turns_about = 3
    usual_name = "yaw"
