"""A joint of a segmented beam, which also gives back what straight segments shorten too much."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from vehicledyn.base.registry import register
from vehicledyn.multibody.joints.joint_type import Axes, JointType, choice, setting
from vehicledyn.symbolic import rotations
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

BEND = "bend"
"""Kind of the joints; beams give them to their segments, no file names them."""


@register("deformation_type", "bend")
@dataclass(frozen=True)
class Bend(JointType):
    """Turn by q about an axis, and shift by d = ½ c q² along the first axis before the joint."""

    unit = "rad"

    axis: Literal[2, 3] = choice("Axis it turns about")
    reach: Scalar = setting("m", "Length c")

    @property
    def angle_about(self) -> int:
        """The axis it turns about."""
        return self.axis

    @property
    def has_constant_axes(self) -> bool:
        """Whether the shift has one direction beyond the joint: no."""
        return False

    def rotation(self, q: Scalar) -> Mat:
        """Return the turn by q."""
        return rotations.turn(self.axis, q)

    def displacement(self, q: Scalar) -> Vec:
        """Return the shift [m]."""
        return rotations.axis_vector(1) * (0.5 * self.reach * q * q)

    def motion(self, q: Scalar) -> Axes:
        """Return the axis, and c q along the first axis as the turned frame sees it."""
        shift = rotations.axis_vector(1) * (self.reach * q)
        return Axes(
            angular=rotations.axis_vector(self.axis),
            linear=rotations.turn(self.axis, q).T @ shift,
        )

    def is_turned_by_mirror(self, axis: int) -> bool:
        """Return whether the mirror image turns the other way."""
        return axis != self.axis
