"""Forces on coordinates: springs of joints, motors, brakes, friction."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar


@dataclass(frozen=True)
class CoordinateForce(BasePart):
    """A force on one coordinate, positive the way the coordinate grows.

    ``law`` takes the situation and returns the force [N, or N m on an angle]; ``unit`` says
    which of the two.
    """

    coordinate: str
    law: Callable[[Situation], Scalar]
    unit: str = "N"

    def loads(self, situation: Situation) -> Loads:
        """Return the force on the coordinate."""
        return Loads(joint_forces={self.coordinate: self.law(situation)})

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the force."""
        channel = Channel(f"{self.name}.force", self.unit, f"Force on {self.coordinate}", "joint")
        return (Output(channel, self.law(situation)),)
