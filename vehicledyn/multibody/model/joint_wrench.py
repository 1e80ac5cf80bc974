"""The wrench that a joint transmits, and how it moves from frame to frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from vehicledyn.symbolic import ops

if TYPE_CHECKING:
    from vehicledyn.multibody.joints.joint_type import Axes
    from vehicledyn.multibody.model.kinematics import Kinematics
    from vehicledyn.symbolic.ops import Mat, Scalar, Vec


@dataclass(frozen=True)
class JointWrench:
    """Force [N] and torque [N m] that a link's joint transmits, in the link's axes."""

    force: Vec
    torque: Vec

    def plus(self, other: JointWrench, rotation: Mat, arm: Vec) -> JointWrench:
        """Return the sum with a wrench of a frame beyond, turned and displaced by ``arm``."""
        return self.added_to(other.turned(rotation, arm))

    def turned(self, rotation: Mat, arm: Vec) -> JointWrench:
        """Return the wrench in a frame before it: turned, its origin displaced by ``arm``."""
        force = rotation @ self.force
        return JointWrench(force, ops.plus_cross(rotation @ self.torque, arm, force))

    def added_to(self, other: JointWrench) -> JointWrench:
        """Return the sum with a wrench at the same origin and in the same axes."""
        return JointWrench(self.force + other.force, self.torque + other.torque)

    def times(self, factor: Scalar) -> JointWrench:
        """Return a multiple of the wrench."""
        return JointWrench(factor * self.force, factor * self.torque)

    def in_parent(self, kinematics: Kinematics, link: int) -> JointWrench:
        """Return the wrench of a link at the origin and in the axes of its parent."""
        return self.turned(kinematics.link_rotation(link), kinematics.link_arm(link))

    def along(self, kinematics: Kinematics, link: int) -> Scalar:
        """Return its share on the coordinate of a link that has a joint [N or N m]."""
        return self.along_axes(kinematics.link_axes(link))

    def along_axes(self, axes: Axes) -> Scalar:
        """Return its share on a coordinate that moves the link along and about some axes."""
        if axes.angular is None:
            return ops.dot(axes.linear, self.force)
        turning = ops.dot(axes.angular, self.torque)
        return turning if axes.linear is None else turning + ops.dot(axes.linear, self.force)
