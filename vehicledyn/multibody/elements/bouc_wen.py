"""Dampers with hysteresis after Bouc and Wen: magnetorheological ones, wire ropes, leaf springs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from vehicledyn.base.registry import register
from vehicledyn.base.shapes import Shape
from vehicledyn.multibody.elements.point_forces import Attachment, LineOfAction, coil_between
from vehicledyn.multibody.model.declaration import attachment, function, number
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel, Variable
from vehicledyn.symbolic.ops import Scalar

HYSTERESIS = "hysteresis"
FLOOR = 1e-12
"""Least |z| that is raised to a power, whose logarithm the derivatives need [1]."""


@register("element_type", "bouc_wen")
@dataclass(frozen=True, kw_only=True)
class BoucWen(BasePart):
    """Hysteretic force along the line between two points, with a spring and a viscous damper.

    With the length L between the points and the hysteresis z, a state between -1 and 1,

        F = F_y z + k (L - L₀) + c L̇,    u ż = L̇ (1 - (1 - γ) |z|ⁿ) - γ |L̇| z |z|ⁿ⁻¹

    F is positive in tension. Pulled from rest z grows with the slope 1/u and reaches 1 at n → ∞ at
    the length u; turned back it leaves 1 with the slope 2 γ/u. From γ = 1/2 on hysteresis takes
    energy in every cycle. F_y may follow the current of a magnetorheological damper.

    References
    ----------
    Wen (1976), Method for random vibration of hysteretic systems, J. Eng. Mech. Div. ASCE 102(2),
    249-263; Spencer, Dyke, Sain, Carlson (1997), Phenomenological model for magnetorheological
    dampers, J. Eng. Mech. 123(3), 230-238, their simple model.
    """

    a: Attachment = attachment("One end")
    b: Attachment = attachment("The other end")
    yield_force: Callable[[Situation], Scalar] = function(
        "N", "Hysteretic force F_y where it yields, not negative", of="motion"
    )
    yield_length: Scalar = number("m", "Stretch u in which it yields", above=0.0)
    exponent: Scalar = number("1", "Exponent n, sharpness of the yield", default=2.0, least=1.0)
    shape: Scalar = number("1", "Part γ of the loss in the slope", default=0.5, least=0.0)
    damping: Scalar = number("N*s/m", "Viscous damping c", default=0.0, least=0.0)
    stiffness: Scalar = number("N/m", "Stiffness k", default=0.0, least=0.0)
    free_length: Scalar = number("m", "Length L₀ without the spring's force", default=0.0)

    def states(self) -> tuple[Variable, ...]:
        """Return the hysteresis."""
        return (Variable(HYSTERESIS, "1", f"Hysteretic part of the force of {self.name}"),)

    def loads(self, situation: Situation) -> Loads:
        """Return the pair of opposite forces and the rate of the hysteresis."""
        line, rate = self._line(situation), self._line(situation).rate
        z = situation.states[HYSTERESIS]
        size = ops.maximum(ops.absolute(z), FLOOR)
        taken = (1.0 - self.shape) * rate * size**self.exponent
        taken = taken + self.shape * ops.absolute(rate) * z * size ** (self.exponent - 1.0)
        return Loads(
            wrenches=line.pair(line.direction * self._force(situation, line)),
            rates={HYSTERESIS: (rate - taken) / self.yield_length},
        )

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return length, its rate and the force."""
        line = self._line(situation)
        words = f"Force of {self.name}, positive in tension"
        return (
            Output(Channel(f"{self.name}.length", "m", f"Length of {self.name}"), line.length),
            Output(
                Channel(f"{self.name}.rate", "m/s", f"Rate of the length {self.name}"), line.rate
            ),
            Output(Channel(f"{self.name}.force", "N", words), self._force(situation, line)),
        )

    def shapes(self) -> tuple[Shape, ...]:
        """Return a spring between the points."""
        return (coil_between(self.name, self.a, self.b),)

    def _line(self, situation: Situation) -> LineOfAction:
        return LineOfAction.between(situation.kinematics, self.a, self.b)

    def _force(self, situation: Situation, line: LineOfAction) -> Scalar:
        hysteretic = self.yield_force(situation) * situation.states[HYSTERESIS]
        spring = self.stiffness * (line.length - self.free_length)
        return hysteretic + spring + self.damping * line.rate
