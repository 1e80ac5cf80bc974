"""FASTSIM as published: three flexibilities, sliding or not."""

from __future__ import annotations

from pydantic import Field

from vehicledyn.base.registry import register
from vehicledyn.rail.creep.creep_law import CreepContact, CreepForces, CreepLaw, floored_limit
from vehicledyn.rail.creep.simplified_theory import march, rates_of, total


@register("creep", "fastsim_1982")
class Fastsim1982(CreepLaw):
    """FASTSIM as published, on a finer kind of grid.

    See :mod:`vehicledyn.rail.creep.simplified_theory`. Where creep and spin are large the unequal
    flexibilities
    turn the tractions away from the slip, up to 9 % of μ N at a/b = 1/2; where spin alone slides
    it is nearer to the exact curves than ``fastsim``.

    References
    ----------
    Kalker (1982), A fast algorithm for the simplified theory of rolling contact, Vehicle System
    Dynamics 11, 1-13.
    """

    strips: int = Field(default=10, description="Number of strips across the contact", ge=2, le=400)
    elements: int = Field(
        default=16, description="Number of elements along each strip", ge=2, le=400
    )

    def forces(self, contact: CreepContact) -> CreepForces:
        """Return forces and spin moment of the tractions."""
        limit = self.friction * contact.normal_force
        rates = rates_of(contact, floored_limit(limit), self.stiffness_factor)
        return total(contact, limit, march(rates, rates, self.strips, self.elements))
