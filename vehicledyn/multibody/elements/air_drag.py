"""Air drag: a force at the origin of a body against its forward speed, in still air."""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.base.registry import register
from vehicledyn.multibody.model.declaration import body_name, number
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation, Wrench
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar


@register("element_type", "air_drag")
@dataclass(frozen=True)
class AirDrag(BasePart):
    """Air drag F = -½ ρ A v |v| along the first axis of a body, A = c_w times the front area."""

    body: str = body_name("The body")
    drag_area: Scalar = number("m^2", "Drag coefficient times front area A", least=0.0)
    density: Scalar = number("kg/m^3", "Density ρ of the air", default=1.225, above=0.0)

    def loads(self, situation: Situation) -> Loads:
        """Return the force on the body."""
        force = ops.vector(self._force(situation), 0.0, 0.0)
        return Loads(wrenches=(Wrench(self.body, force, ops.vector(0.0, 0.0, 0.0)),))

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the force."""
        channel = Channel(f"{self.name}.force", "N", "Air drag, positive forward", self.body)
        return (Output(channel, self._force(situation)),)

    def _force(self, situation: Situation) -> Scalar:
        kinematics = situation.kinematics
        forward = (kinematics.rotation(self.body).T @ kinematics.velocity(self.body))[0]
        return -0.5 * self.density * self.drag_area * forward * ops.absolute(forward)
