"""Creep law of Shen, Hedrick and Elkins: Kalker's linear forces bent by a cubic."""

from __future__ import annotations

from vehicledyn.base.registry import register
from vehicledyn.rail.creep.creep_law import (
    CreepContact,
    CreepForces,
    CreepLaw,
    kalker_forces,
    scaled,
)
from vehicledyn.rail.creep.cubic_saturation import cubic_part


@register("creep", "shen_hedrick_elkins")
class ShenHedrickElkins(CreepLaw):
    """Kalker's linear forces, spin included, bent towards friction by a cubic.

    With ρ = |F_linear| / (μ N) the force is μ N (ρ - ρ²/3 + ρ³/27) in the direction of F_linear
    for ρ < 3, and μ N beyond; the spin moment is reduced in the same proportion. Good for small
    spin, that is away from flange contact: at large spin the exact lateral force falls again,
    this one does not.

    References
    ----------
    Shen, Hedrick, Elkins (1983), A comparison of alternative creep-force models for rail vehicle
    dynamic analysis, Proc. 8th IAVSD Symposium, 591-605.
    """

    def forces(self, contact: CreepContact) -> CreepForces:
        """Return the bent linear forces."""
        linear = kalker_forces(contact, self.stiffness_factor)
        limit = self.friction * contact.normal_force
        return scaled(linear, cubic_part(linear.longitudinal, linear.lateral, limit))
