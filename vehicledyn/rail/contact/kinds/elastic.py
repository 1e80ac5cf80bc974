"""Elastic contact: Hertz's theory in every place where wheel and rail overlap."""

from __future__ import annotations

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.multibody.model.parts import Part
from vehicledyn.rail.contact.rail_contact import RailContact, RailWheels
from vehicledyn.symbolic.parameters import ParameterTable


@register("rail_contact", "elastic")
class Elastic(RailContact):
    """Hertz's theory in every place where wheel and rail overlap.

    The normal force of a contact with approach δ is N (1 + d δ̇), never below zero, where N is
    Hertz's. Wheel and rail are of one material.
    """

    youngs_modulus: float = quantity("N/m^2", "E of wheel and rail", gt=0)
    poissons_ratio: float = quantity("1", "ν of wheel and rail", ge=0, le=0.5)
    damping: float = quantity("s/m", "d, part of the force added a unit of closing speed", ge=0)
    angle_of_attack: float | None = quantity(
        "rad",
        "Largest angle of attack for which contacts that jump have windows of their own; from "
        "the tightest curve and the distance of axles if left out",
        default=None,
        ge=0,
    )

    def entered(self, table: ParameterTable) -> Elastic:
        """Return the model with symbols; Poisson's ratio stays a number, which is cheaper."""
        name = f"{self.family}."
        modulus = table.add(
            f"{name}youngs_modulus", self.youngs_modulus, "N/m^2", "Young's modulus"
        )
        damping = table.add(f"{name}damping", self.damping, "s/m", "Damping of the contact")
        return Elastic.model_construct(
            youngs_modulus=modulus,
            poissons_ratio=self.poissons_ratio,
            damping=damping,
            angle_of_attack=self.angle_of_attack,
        )

    def part(self, wheels: RailWheels) -> Part:
        """Return the part."""
        from vehicledyn.rail.contact.known_contacts import contact_of
        from vehicledyn.rail.contact.wheel_grid import largest_attack
        from vehicledyn.rail.contact.wheel_on_rail import ElasticWheels

        attack = self.angle_of_attack
        if attack is None:
            attack = largest_attack(wheels.track.line.tightest, wheels.nearest)
        modulus, nu = self.youngs_modulus, self.poissons_ratio
        return ElasticWheels(
            wheels.name,
            wheels,
            contact_of(*wheels.geometry(), attack),
            effective_modulus=modulus / (2.0 * (1.0 - nu * nu)),
            shear_modulus=modulus / (2.0 * (1.0 + nu)),
            poissons_ratio=nu,
            damping=self.damping,
        )
