"""Forces on coordinates: springs of joints, motors, brakes, friction."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from vehicledyn.base.registry import register
from vehicledyn.multibody.model.declaration import choice, coordinate_name, law
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


@register("element_type", "spring")
@dataclass(frozen=True)
class CoordinateSpring(BasePart):
    """A spring or damper on a coordinate: its force is minus what the law gives."""

    coordinate: str = coordinate_name("The coordinate")
    law: Callable[[Scalar, Scalar], Scalar] = law(
        "force_law", "Force against the coordinate, as in a spring"
    )
    mirrored: bool = choice(
        "Take the law of the opposite coordinate", default=False, turns_with=("coordinate",)
    )

    def loads(self, situation: Situation) -> Loads:
        """Return the force on the coordinate."""
        return Loads(joint_forces={self.coordinate: self._force(situation)})

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the force."""
        unit = situation.kinematics.tree.force_unit(self.coordinate)
        channel = Channel(f"{self.name}.force", unit, f"Force on {self.coordinate}", "joint")
        return (Output(channel, self._force(situation)),)

    def _force(self, situation: Situation) -> Scalar:
        sign = -1.0 if self.mirrored else 1.0
        position = sign * situation.kinematics.coordinate(self.coordinate)
        rate = sign * situation.kinematics.rate(self.coordinate)
        return -sign * self.law(position, rate)
