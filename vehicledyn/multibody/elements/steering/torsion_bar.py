"""Torsion bars between two turning coordinates, as between steering column and pinion."""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.base.registry import register
from vehicledyn.multibody.model.declaration import coordinate_name, number
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar


@register("element_type", "torsion_bar")
@dataclass(frozen=True, kw_only=True)
class TorsionBar(BasePart):
    """A torsion spring and damper between two coordinates that turn about one axis.

        T = k (q - q_other) + c (q̇ - q̇_other)

    acts against ``coordinate`` and along ``other``. It stores ½ k (q - q_other)² and loses
    c (q̇ - q̇_other)².
    """

    coordinate: str = coordinate_name("Turn of the one end")
    other: str = coordinate_name("Turn of the other end, about the same axis")
    stiffness: Scalar = number("N*m/rad", "Torsional stiffness k", above=0.0)
    damping: Scalar = number("N*m*s/rad", "Torsional damping c", default=0.0, least=0.0)

    def loads(self, situation: Situation) -> Loads:
        """Return the torques on both ends."""
        torque = self._torque(situation)
        return Loads(joint_forces={self.coordinate: -torque, self.other: torque})

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return twist, torque and stored energy."""
        name, twist = self.name, self._twist(situation)
        text = f"Torque on {self.other}"
        energy = Channel(f"{name}.energy", "J", f"Energy stored in {name}")
        return (
            Output(Channel(f"{name}.twist", "rad", f"Twist of {name}"), twist),
            Output(Channel(f"{name}.torque", "N*m", text), self._torque(situation)),
            Output(energy, 0.5 * self.stiffness * twist * twist),
        )

    def _twist(self, situation: Situation) -> Scalar:
        k = situation.kinematics
        return k.coordinate(self.coordinate) - k.coordinate(self.other)

    def _torque(self, situation: Situation) -> Scalar:
        k = situation.kinematics
        rate = k.rate(self.coordinate) - k.rate(self.other)
        return self.stiffness * self._twist(situation) + self.damping * rate
