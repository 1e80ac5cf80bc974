"""Universal wheels: hubs with free rollers, as the rate constraint that these leave on average."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import register
from vehicledyn.base.shapes import Anchor, Plane, Shape, Wheel
from vehicledyn.multibody.model.constraints import BaseConstraint, Movement
from vehicledyn.multibody.model.cuts import Residual
from vehicledyn.multibody.model.declaration import ORIGIN, body_name, choice, number, vector
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar, Vec

FEWEST_ROLLERS = 3


@register("constraint_type", "universal_wheel")
@dataclass(frozen=True)
class UniversalWheel(BaseConstraint):
    """A wheel on the plane z = 0 whose rollers let it slide across their axes (omni, mecanum).

    With the horizontal axle e, the way d = e × z that it rolls and the angle γ from the axle to
    the axis a = e cos γ + d sin γ of the roller that touches, the touching point has no velocity
    along a: a · v = R φ̇ (a · d). The rollers are averaged; an omni wheel has γ = 90 deg, mecanum
    wheels have 45 and -45 deg. Its height is not held.

    A roller that touches at the angle θ of the wheel from its middle leans, and its axis over the
    ground is along e cos γ + d sin γ cos θ. A wheel of n rollers that turns has on average cos θ =
    sin(π/n) / (π/n), which ``rollers`` takes into account: 2.6 % for 8, none for an omni wheel.
    """

    body: str = body_name("The hub; it may have spins_about")
    axis: Literal[1, 2, 3] = choice("Axis of the wheel in its body")
    radius: Scalar = number("m", "Radius R over the rollers", above=0.0)
    roller_angle: Scalar = number(
        "rad", "Angle γ from the axle to the roller's axis at the ground", nature="handed"
    )
    centre: Sequence[Scalar] = vector(
        "m", "Centre of the wheel in the axes of the body", default=ORIGIN
    )
    rollers: int | None = choice(
        "Number n of rollers, at least 3; as many as there can be if left out", default=None
    )

    def __post_init__(self) -> None:
        """Refuse too few rollers."""
        if self.rollers is not None and self.rollers < FEWEST_ROLLERS:
            raise InputError(
                f"rollers: {self.rollers} are too few; a wheel has at least {FEWEST_ROLLERS}"
            )

    def speeds(self, movement: Movement) -> list[Residual]:
        """Return the velocity of the touching point along the roller's axis [m/s]."""
        e = movement.rotation(self.body)[:, self.axis - 1]
        flat = ops.sqrt(e[0] * e[0] + e[1] * e[1])
        axle = ops.vector(e[0] / flat, e[1] / flat, 0.0)
        way = ops.vector(axle[1], -axle[0], 0.0)
        sine = ops.sin(self.roller_angle) * self._mean_cosine
        roller = ops.cos(self.roller_angle) * axle + sine * way
        velocity = movement.velocity(self.body, self._lowest(movement, e, flat))
        text = "Force of the ground along the axis of the roller"
        along = roller[0] * velocity[0] + roller[1] * velocity[1]
        return [Residual(along, "m/s", "roller_force", "N", text)]

    def shapes(self) -> tuple[Shape, ...]:
        """Return the wheel and the ground."""
        axis = tuple(1.0 if k == self.axis else 0.0 for k in (1, 2, 3))
        place = Anchor(self.body, tuple(self.centre))
        return (
            Wheel(self.name, place, axis, self.radius, 0.5 * self.radius, style="disc"),
            Plane("ground", (0.0, 0.0, 0.0)),
        )

    @property
    def _mean_cosine(self) -> float:
        """Mean of cos θ over the turn in which one roller touches."""
        if self.rollers is None:
            return 1.0
        half = math.pi / self.rollers
        return math.sin(half) / half

    def _lowest(self, movement: Movement, e: Vec, flat: Scalar) -> list[Scalar]:
        """Return the lowest point of the wheel in the axes of the body [m]."""
        down = ops.vector(e[0] * e[2] / flat, e[1] * e[2] / flat, -flat)
        arm = movement.position(self.body, self.centre) + self.radius * down
        local = movement.rotation(self.body).T @ (arm - movement.position(self.body))
        return [local[k] for k in range(3)]
