"""The foot on a pedal: a pedal that follows what is wanted of it with a lag."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from vehicledyn.multibody.elements.triggers import VALUE
from vehicledyn.multibody.model.parts import BasePart, Loads, Situation
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Variable
from vehicledyn.symbolic.ops import Scalar

LAG = 0.02
"""Time constant of foot, booster and brake lines together [s]; estimated."""


@dataclass(frozen=True)
class Foot(BasePart):
    """A pedal from 0 to 1 in place of the switch of its name.

    p' = (max(0, min(1, u)) - p) / τ with the wanted pedal u and τ = 0.02 s.
    """

    wanted: Callable[[Situation], Scalar]

    def states(self) -> tuple[Variable, ...]:
        """Return how far the pedal is pressed."""
        return (Variable(VALUE, "1", f"Pedal '{self.name}'"),)

    def loads(self, situation: Situation) -> Loads:
        """Return the rate of the pedal."""
        wanted = ops.minimum(ops.maximum(self.wanted(situation), 0.0), 1.0)
        return Loads(rates={VALUE: (wanted - situation.states[VALUE]) / LAG})
