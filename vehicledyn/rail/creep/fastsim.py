"""FASTSIM: Kalker's simplified theory on a grid of strips and elements."""

from __future__ import annotations

from pydantic import Field

from vehicledyn.base.registry import register
from vehicledyn.rail.creep_law import CreepContact, CreepForces, CreepLaw, floored_limit
from vehicledyn.rail.fastsim import march, rates_of, total


@register("creep", "fastsim")
class Fastsim(CreepLaw):
    """FASTSIM of Kalker, with three flexibilities and a parabolic bound of the tractions.

    See :mod:`vehicledyn.rail.fastsim`. Within 8 % of μ N of the exact solution, with spin too. The
    spin moment is that of these tractions, which is up to a third short of the exact one. More
    strips and elements bring the result nearer to the simplified theory, not to the exact one:
    10 by 10 are within 3.5 % of μ N of infinitely many (narrow contacts that spin fast: 8 %),
    20 by 20 within 3 %, and without spin 10 by 10 within 0.3 %.
    :func:`vehicledyn.rail.fastsim.fine_forces` takes as many as a tolerance asks for.

    References
    ----------
    Kalker (1982), A fast algorithm for the simplified theory of rolling contact, Vehicle System
    Dynamics 11, 1-13.
    """

    strips: int = Field(default=10, description="Number of strips across the contact", ge=2, le=400)
    elements: int = Field(
        default=10, description="Number of elements along each strip", ge=2, le=400
    )

    def forces(self, contact: CreepContact) -> CreepForces:
        """Return forces and spin moment of the tractions."""
        limit = self.friction * contact.normal_force
        rates = rates_of(contact, floored_limit(limit), self.stiffness_factor)
        return total(contact, limit, march(rates, self.strips, self.elements))
