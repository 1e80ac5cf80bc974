"""A nut on a screw: a turn and the advance that goes with it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from vehicledyn.base.registry import register
from vehicledyn.multibody.joints.joint_type import Axes, JointType, choice, setting
from vehicledyn.symbolic import rotations
from vehicledyn.symbolic.ops import Mat, Scalar, Vec


@register("joint_type", "screw")
@dataclass(frozen=True)
class Screw(JointType):
    """Turn by q about an axis e and advance along it by d = (lead / 2π) q e.

    The friction of the thread is no part of it; a spring or force on the coordinate is a torque
    on the nut.
    """

    unit = "rad"

    axis: Literal[1, 2, 3] = choice("Axis of the screw")
    lead: Scalar = setting(
        "m", "Advance in one turn, positive for a right-hand thread", is_handed=True
    )

    @property
    def angle_about(self) -> int:
        """The axis of the screw."""
        return self.axis

    @property
    def _advance(self) -> Scalar:
        """Advance over angle [m/rad]."""
        return self.lead / (2.0 * math.pi)

    def rotation(self, q: Scalar) -> Mat:
        """Return the turn by q."""
        return rotations.turn(self.axis, q)

    def displacement(self, q: Scalar) -> Vec:
        """Return the advance [m]."""
        return rotations.axis_vector(self.axis) * (self._advance * q)

    def motion(self, q: Scalar) -> Axes:
        """Return e, and the advance over angle along it."""
        axis = rotations.axis_vector(self.axis)
        return Axes(angular=axis, linear=axis * self._advance)

    def is_turned_by_mirror(self, axis: int) -> bool:
        """Return whether the mirror image turns the other way."""
        return axis != self.axis
