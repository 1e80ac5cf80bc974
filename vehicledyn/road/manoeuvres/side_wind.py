"""A gust from the side: a lateral force by time on the chassis."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation, Wrench
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Scalar


@dataclass(frozen=True)
class SideWind(BasePart):
    """A lateral force by time on the chassis at a distance ahead of its origin, for gusts."""

    chassis: str
    force: Callable[[Scalar], Scalar]
    ahead: Scalar

    def loads(self, situation: Situation) -> Loads:
        """Return the force."""
        force = situation.hand("force", ops.scalar(self.force(situation.time)))
        pushed = ops.vector(0.0, force, 0.0)
        return Loads(
            wrenches=(Wrench(self.chassis, pushed, ops.vector(0.0, 0.0, self.ahead * force)),)
        )

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the force."""
        channel = Channel(f"{self.name}.force", "N", "Lateral force of the wind, to the left")
        return (Output(channel, ops.scalar(self.force(situation.time))),)
