"""Carter's creep law: the exact one of rolling cylinders, for forces in any direction."""

from __future__ import annotations

from vehicledyn.base.registry import register
from vehicledyn.rail.creep.creep_law import (
    RELATIVE_FLOOR,
    CreepContact,
    CreepForces,
    CreepLaw,
    floored_limit,
    kalker_forces,
    scaled,
)
from vehicledyn.symbolic import ops


@register("creep", "carter")
class Carter(CreepLaw):
    """Kalker's linear forces, spin included, bent towards friction by Carter's parabola.

    With ρ = |F_linear| / (μ N) the force is μ N (ρ - ρ²/4) in the direction of F_linear for
    ρ < 2, and μ N beyond; the spin moment is reduced in the same proportion. The parabola is
    exact for elastic cylinders that roll across their axes, where all sections slide alike; an
    elliptical contact slides piece by piece, so that friction is reached later than here.

    References
    ----------
    Carter (1926), On the action of a locomotive driving wheel, Proc. R. Soc. Lond. A 112, 151-157.
    """

    def forces(self, contact: CreepContact) -> CreepForces:
        """Return the bent linear forces."""
        linear = kalker_forces(contact, self.stiffness_factor)
        limit = self.friction * contact.normal_force
        floor = floored_limit(limit)
        relative = ops.smooth_norm(
            linear.longitudinal / floor, linear.lateral / floor, RELATIVE_FLOOR
        )
        bent = ops.minimum(relative, 2.0)
        return scaled(linear, (bent - 0.25 * bent * bent) / relative * (limit / floor))
