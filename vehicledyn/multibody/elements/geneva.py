"""Geneva drives: a pin moves a slotted wheel by steps, a locking arc holds it between."""

from __future__ import annotations

import math
from dataclasses import dataclass

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import register
from vehicledyn.multibody.model.constraints import BaseConstraint, Geometry
from vehicledyn.multibody.model.cuts import Proportional, Residual
from vehicledyn.multibody.model.declaration import choice, coordinate_name, number
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

_TURN = 2.0 * math.pi
_LEAST = 3


@register("constraint_type", "geneva")
@dataclass(frozen=True)
class GenevaDrive(BaseConstraint):
    """A wheel with n slots that a pin turns by 1/n at each turn of the driver, and a lock between.

    With λ = sin(π/n), the pin's radius over the distance of the axes, and the angle α of the driver
    from the line of the axes, an outer wheel turns by -atan2(λ sin α, 1 - λ cos α) while the pin is
    in a slot, |α| < π/2 - π/n; an inner one by atan2(λ sin α, 1 + λ cos α) for |α| < π/2 + π/n. The
    rate is continuous, the acceleration jumps where the pin enters and leaves.
    """

    driver: str = coordinate_name("Angle of the driver; zero with the pin deepest in its slot")
    wheel: str = coordinate_name("Angle of the wheel")
    slots: int = choice("Number of slots n, at least 3")
    distance: Scalar = number("m", "Distance of the axes", above=0.0)
    internal: bool = choice("Whether the pin is inside the wheel", default=False)

    def __post_init__(self) -> None:
        """Refuse wheels whose slots no pin can leave."""
        if self.slots < _LEAST:
            raise InputError(
                f"slots: {self.slots} is too few; a Geneva wheel has at least {_LEAST}"
            )

    def residuals(self, geometry: Geometry) -> list[Residual]:
        """Return the wheel's angle less the one that pin or lock gives it [rad]."""
        turned = geometry.coordinate(self.driver)
        step, ratio = _TURN / self.slots, math.sin(math.pi / self.slots)
        sign = 1.0 if self.internal else -1.0
        turns = ops.floor((turned + math.pi) / _TURN)
        angle = turned - _TURN * turns
        reach = 0.5 * math.pi + (0.5 * step if self.internal else -0.5 * step)
        held = ops.minimum(ops.maximum(angle, -reach), reach)
        away = 1.0 + sign * ratio * ops.cos(held)
        swing = ops.atan2(ratio * ops.sin(held), away)
        wheel = sign * (step * turns + swing)
        in_slot = ops.logic_and(angle > -reach, angle < reach)
        arm = self.distance * ops.sqrt(away * away + (ratio * ops.sin(held)) ** 2)
        pin = Proportional(
            "pin_force",
            "N",
            ops.where(in_slot, 1.0 / arm, 0.0),
            f"Force of the pin of '{self.name}' across its slot; none while locked",
        )
        gap = geometry.coordinate(self.wheel) - wheel
        text = f"Torque of '{self.name}' on the wheel, by pin or lock"
        return [Residual(gap, "rad", "torque", "N*m", text, more=(pin,))]
