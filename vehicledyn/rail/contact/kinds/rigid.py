"""Rigid contact: wheel and rail touch by constraint, the normal force is the multiplier."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.rail.contact.rail_contact import RailContact, RailWheels
from vehicledyn.symbolic.parameters import ParameterTable

if TYPE_CHECKING:
    from vehicledyn.rail.contact.rigid_contact import RigidRailWheels


@register("rail_contact", "rigid")
class Rigid(RailContact):
    """Wheel and rail touch in one point each, by constraint; the normal force is the multiplier.

    The body has as many freedoms less as it has wheels: give no forces that would hold these,
    and mark coordinates whose start must stay as ``role: independent``. Where a wheel touches at
    a second point, the contact jumps there by an event, an impact without rebound. A wheel that
    lifts ends the run. Size and shape of the contact, which creep depends on, are those of Hertz.
    """

    youngs_modulus: float = quantity("N/m^2", "E of wheel and rail", gt=0)
    poissons_ratio: float = quantity("1", "ν of wheel and rail", ge=0, le=0.5)

    def entered(self, table: ParameterTable) -> Rigid:
        """Return the model with symbols; Poisson's ratio stays a number, which is cheaper."""
        name = f"{self.family}.youngs_modulus"
        modulus = table.add(name, self.youngs_modulus, "N/m^2", "Young's modulus")
        return Rigid.model_construct(youngs_modulus=modulus, poissons_ratio=self.poissons_ratio)

    def part(self, wheels: RailWheels) -> RigidRailWheels:
        """Return the part."""
        from vehicledyn.rail.contact.rigid_contact import RigidRailWheels
        from vehicledyn.rail.contact.rigid_profiles import rigid_wheels
        from vehicledyn.rail.contact.rolling_contact import Material

        return RigidRailWheels(
            wheels.name,
            wheels.body,
            rigid_wheels(
                *wheels.geometry(),
                wheels.sides,
                radius=wheels.radius,
                half_distance=wheels.tape_circle,
            ),
            wheels.track,
            wheels.creep,
            Material(self.youngs_modulus, self.poissons_ratio),
            wheels.nominal,
        )
