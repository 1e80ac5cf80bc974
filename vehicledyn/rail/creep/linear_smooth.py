"""Linear creep law with a smooth way to friction."""

from __future__ import annotations

from vehicledyn.base.registry import register
from vehicledyn.rail.creep.creep_law import (
    CreepContact,
    CreepForces,
    CreepLaw,
    floored_limit,
    kalker_forces,
    scaled,
)
from vehicledyn.symbolic import ops


@register("creep", "linear_smooth")
class LinearSmooth(CreepLaw):
    """Kalker's linear forces, bent smoothly towards friction.

    F = F_linear / √(1 + ρ²),  ρ = |F_linear| / (μ N), and the spin moment alike. It is smooth
    everywhere; friction is reached at infinite creep only. The form is known by the names of
    Levi and Chartet.
    """

    def forces(self, contact: CreepContact) -> CreepForces:
        """Return the bent linear forces."""
        linear = kalker_forces(contact, self.stiffness_factor)
        limit = self.friction * contact.normal_force
        x, y = linear.longitudinal, linear.lateral
        return scaled(linear, limit / ops.smooth_norm(x, y, floored_limit(limit)))
