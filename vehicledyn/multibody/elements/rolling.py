"""Wheels that roll without slip on the ground plane z = 0: one holonomic, two rate constraints."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from vehicledyn.base.registry import register
from vehicledyn.base.shapes import Anchor, Plane, Shape, Wheel
from vehicledyn.multibody.model.constraints import BaseConstraint, Geometry, Movement
from vehicledyn.multibody.model.cuts import Residual
from vehicledyn.multibody.model.declaration import ORIGIN, body_name, choice, number, vector
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar, Vec


@register("constraint_type", "rolling_wheel")
@dataclass(frozen=True)
class RollingWheel(BaseConstraint):
    """A wheel with a sharp or round edge that rolls on the plane z = 0 without slip.

    The wheel is a torus: its crown of radius ρ runs on a circle of radius r about the axis.
    With e the axis and d the unit vector in the plane of the wheel that points down most
    steeply, the lowest point is c + r d - ρ z. Its height is zero and the material point there
    has no horizontal velocity. The wheel must not lie flat (e along z).
    """

    body: str = body_name("The wheel; it may have spins_about")
    axis: Literal[1, 2, 3] = choice("Axis of the wheel in its body")
    radius: Scalar = number("m", "Radius r of the edge, or to the centre of the crown", above=0.0)
    crown: Scalar = number("m", "Radius ρ of the crown; zero is sharp", default=0.0, least=0.0)
    centre: Sequence[Scalar] = vector(
        "m", "Centre of the wheel in the axes of the body", default=ORIGIN
    )

    def residuals(self, geometry: Geometry) -> list[Residual]:
        """Return the height of the lowest point [m]; its multiplier is the normal force."""
        text = "Normal force of the ground on the wheel"
        height = self._lowest(geometry)[2]
        return [Residual(height, "m", "normal_force", "N", text)]

    def speeds(self, movement: Movement) -> list[Residual]:
        """Return the horizontal velocity of the touching point [m/s], along and across.

        The forces are along the track of the wheel and to the left of it.
        """
        kinematics = movement.kinematics
        arm = self._lowest(movement) - movement.position(self.body)
        local = movement.rotation(self.body).T @ arm
        velocity = kinematics.velocity(self.body, [local[k] for k in range(3)])
        left = self._left(movement)
        along = left[1] * velocity[0] - left[0] * velocity[1]
        across = left[0] * velocity[0] + left[1] * velocity[1]
        return [
            Residual(along, "m/s", "longitudinal_force", "N", "Force along the track"),
            Residual(across, "m/s", "lateral_force", "N", "Force to the left of the track"),
        ]

    def shapes(self) -> tuple[Shape, ...]:
        """Return the wheel and the ground it rolls on."""
        axis = tuple(1.0 if k == self.axis else 0.0 for k in (1, 2, 3))
        radius, width = self.radius + self.crown, None
        if isinstance(self.crown, int | float) and self.crown == 0.0:
            width = 0.06 * self.radius
        place = Anchor(self.body, tuple(self.centre))
        return (
            Wheel(self.name, place, axis, radius, width, style="disc"),
            Plane("ground", (0.0, 0.0, 0.0)),
        )

    def _axis(self, geometry: Geometry) -> Vec:
        """Return the axis e in world axes."""
        return geometry.rotation(self.body)[:, self.axis - 1]

    def _left(self, geometry: Geometry) -> Vec:
        """Return the horizontal unit vector of the axis."""
        e = self._axis(geometry)
        return ops.unit(ops.vector(e[0], e[1], 0.0))

    def _lowest(self, geometry: Geometry) -> Vec:
        e = self._axis(geometry)
        flat = ops.sqrt(e[0] * e[0] + e[1] * e[1])
        down = ops.vector(e[0] * e[2] / flat, e[1] * e[2] / flat, -flat)
        centre = geometry.position(self.body, self.centre)
        return centre + self.radius * down - ops.vector(0.0, 0.0, self.crown)
