"""A roller on a plane: it turns and travels without slip."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import register
from vehicledyn.multibody.joints.joint_type import Axes, JointType, choice, setting
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.ops import Mat, Scalar, Vec


@register("joint_type", "rolling")
@dataclass(frozen=True)
class Rolling(JointType):
    """Turn by q about an axis e whose middle travels by r q (e × n) over a plane of normal n.

    A cylinder on a floor, a pinion on a fixed rack, a disk that stays upright. Neither slip nor
    lift is possible; the force of the contact is that of the joint.
    """

    unit = "rad"

    axis: Literal[1, 2, 3] = choice("Axis it turns about")
    normal: Literal[1, 2, 3] = choice("Axis from the plane to the middle, another one")
    radius: Scalar = setting("m", "Radius r, negative for a middle on the other side of the plane")

    def __post_init__(self) -> None:
        """Refuse an axis along the normal, about which nothing rolls."""
        if self.axis == self.normal:
            raise InputError(f"the normal is the axis, {self.axis}, about which nothing rolls")

    @property
    def angle_about(self) -> int:
        """The axis it turns about."""
        return self.axis

    @property
    def has_constant_axes(self) -> bool:
        """Whether the direction of travel turns in the frame of the roller: it does."""
        return False

    def rotation(self, q: Scalar) -> Mat:
        """Return the turn by q."""
        return rotations.turn(self.axis, q)

    def displacement(self, q: Scalar) -> Vec:
        """Return the travel [m]."""
        return self._travel * q

    def motion(self, q: Scalar) -> Axes:
        """Return e, and the travel over angle as the turned frame sees it."""
        return Axes(
            angular=rotations.axis_vector(self.axis),
            linear=rotations.turn(self.axis, q).T @ self._travel,
        )

    def is_turned_by_mirror(self, axis: int) -> bool:
        """Return whether the mirror image turns the other way."""
        return axis != self.axis

    def handed_settings(self, axis: int) -> tuple[str, ...]:
        """Return the radius where the mirror exchanges the sides of the plane."""
        return ("radius",) if axis == self.normal else ()

    @property
    def _travel(self) -> Vec:
        """Travel over angle [m/rad]."""
        axis, normal = (rotations.axis_vector(k) for k in (self.axis, self.normal))
        return ops.cross(axis, normal) * self.radius
