"""Hydraulic lash elements: oil behind a check valve keeps a valve train without clearance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from vehicledyn.base.registry import register
from vehicledyn.base.shapes import Anchor, Shape, Tube
from vehicledyn.multibody.elements.contacts.touch import Touch, pair_of_forces
from vehicledyn.multibody.elements.point_forces import Attachment
from vehicledyn.multibody.model.declaration import attachment, number
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import BasePart, Loads, Output, Situation
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel, Variable
from vehicledyn.symbolic.labels import unlabelled
from vehicledyn.symbolic.ops import Scalar, Vec

PRESSURE = "pressure"


@register("element_type", "hydraulic_lash")
@dataclass(frozen=True, kw_only=True)
class HydraulicLash(BasePart):
    """A plunger on a chamber of oil with a check valve, a leaking gap and a spring.

    With the length L between its ends and the pressure p over that of the supply,

        ṗ = K / (V + A (L - L₀)) (-A L̇ - c_l p + c_v max(-p, 0))

    and the ends are pushed apart by A p + F₀ - k (L - L₀). The pressure does not fall below
    ``vapour`` under that of the supply.
    """

    a: Attachment = attachment("One end")
    b: Attachment = attachment("The other end")
    area: Scalar = number("m^2", "Area A of the plunger", above=0.0)
    volume: Scalar = number("m^3", "Volume V of the chamber at the length L₀", above=0.0)
    length: Scalar = number("m", "Length L₀", above=0.0)
    bulk_modulus: Scalar = number("Pa", "Bulk modulus K of the oil", above=0.0)
    leakage: Scalar = number("m^3/(s*Pa)", "Leakage c_l of the gap", least=0.0)
    check_valve: Scalar = number("m^3/(s*Pa)", "Conductance c_v of the open check valve", least=0.0)
    stiffness: Scalar = number("N/m", "Stiffness k of the plunger's spring", default=0.0, least=0.0)
    preload: Scalar = number("N", "Force F₀ of the plunger's spring at L₀", default=0.0)

    def states(self) -> tuple[Variable, ...]:
        """Return the pressure over that of the supply."""
        return (Variable(PRESSURE, "Pa", f"Pressure in {self.name} over that of the supply", 0.0),)

    def loads(self, situation: Situation) -> Loads:
        """Return the pair of forces and the rate of the pressure."""
        line, length, rate = self._line(situation.kinematics)
        pressure = situation.states[PRESSURE]
        inflow = self.check_valve * ops.maximum(-pressure, 0.0) - self.leakage * pressure
        volume = self.volume + self.area * (length - self.length)
        rising = self.bulk_modulus / volume * (inflow - self.area * rate)
        bodies = (self.a.body, self.b.body)
        force = self._force(situation, length) * line
        kinematics = situation.kinematics
        # Both forces act at their own ends, on one line, so the point does not matter.
        place = unlabelled(kinematics.position(self.b.body, self.b.point))
        touch = Touch(length, line, place)
        return Loads(
            wrenches=pair_of_forces(kinematics, bodies, touch, force),
            rates={PRESSURE: rising},
        )

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return length and force."""
        _, length, _ = self._line(situation.kinematics)
        force = self._force(situation, length)
        return (
            Output(Channel(f"{self.name}.length", "m", f"Length of {self.name}", "link"), length),
            Output(
                Channel(f"{self.name}.force", "N", f"Force of {self.name} that pushes", "link"),
                force,
            ),
        )

    def shapes(self) -> tuple[Shape, ...]:
        """Return a plunger between the ends."""
        ends: list[Anchor] = [Anchor(e.body, tuple(e.point)) for e in (self.a, self.b)]
        return (Tube(self.name, ends[0], ends[1]),)

    def _force(self, situation: Situation, length: Scalar) -> Scalar:
        spring = self.preload - self.stiffness * (length - self.length)
        return self.area * situation.states[PRESSURE] + spring

    def _line(self, kinematics: Kinematics) -> tuple[Vec, Scalar, Scalar]:
        """Return the unit vector from A to B in world axes, the length and its rate."""
        ends: Sequence[Vec] = [
            unlabelled(kinematics.position(e.body, e.point)) for e in (self.a, self.b)
        ]
        reach = ends[1] - ends[0]
        length = ops.norm(reach)
        return reach / length, length, kinematics.time_derivative(length)
