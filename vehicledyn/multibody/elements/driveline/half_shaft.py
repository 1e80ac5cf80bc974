"""Half shafts: flexible shafts with two joints from a differential to a wheel that moves."""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.base.registry import register
from vehicledyn.multibody.model.declaration import body_name, number
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation, Wrench
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel, Variable
from vehicledyn.symbolic.ops import Scalar, Vec


@register("element_type", "half_shaft")
@dataclass(frozen=True)
class HalfShaft(BasePart):
    """A torsion spring and damper between two bodies that turn about their own y axes.

    With the absolute angular velocities about these axes the twist θ grows by

        θ̇ = Ω_shaft - Ω_wheel,    T = k θ + c θ̇

    and T turns the wheel, -T the shaft, each about its own axis. The joints at its ends pass on
    torque and nothing else, so the wheel's carrier takes no part of it. The gain of energy is
    that of the spring, less c θ̇².
    """

    shaft: str = body_name("The shaft of the differential, which turns about its y axis")
    wheel: str = body_name("The wheel, which turns about its y axis")
    stiffness: Scalar = number("N*m/rad", "Torsional stiffness k", above=0.0)
    damping: Scalar = number("N*m*s/rad", "Torsional damping c", default=0.0, least=0.0)

    def states(self) -> tuple[Variable, ...]:
        """Return the twist."""
        return (Variable("twist", "rad", "Twist of the half shaft"),)

    def loads(self, situation: Situation) -> Loads:
        """Return the torques and the rate of the twist."""
        torque = self._torque(situation)
        return Loads(
            wrenches=(
                Wrench(self.shaft, _nothing(), ops.vector(0.0, -torque, 0.0)),
                Wrench(self.wheel, _nothing(), ops.vector(0.0, torque, 0.0)),
            ),
            rates={"twist": self._rate(situation)},
        )

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the torque on the wheel."""
        channel = Channel(f"{self.name}.torque", "N*m", f"Torque on {self.wheel}", self.wheel)
        return (Output(channel, self._torque(situation)),)

    def _rate(self, situation: Situation) -> Scalar:
        k = situation.kinematics
        return k.angular_velocity(self.shaft)[1] - k.angular_velocity(self.wheel)[1]

    def _torque(self, situation: Situation) -> Scalar:
        twist = situation.states["twist"]
        return self.stiffness * twist + self.damping * self._rate(situation)


def _nothing() -> Vec:
    return ops.vector(0.0, 0.0, 0.0)
