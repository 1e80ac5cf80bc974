"""Linear creep law: Kalker's linear theory, cut off at friction."""

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


@register("creep", "linear")
class Linear(CreepLaw):
    """Kalker's linear forces, cut off at the friction circle.

    With ρ = |F_linear| / (μ N) the force is F_linear min(1, 1/ρ), and so is the spin moment.
    The slope jumps where friction is reached; it follows no exact curve beyond a third of the
    friction limit.

    References
    ----------
    Kalker (1990), Three-Dimensional Elastic Bodies in Rolling Contact, appendix E.
    """

    def forces(self, contact: CreepContact) -> CreepForces:
        """Return the cut off linear forces."""
        linear = kalker_forces(contact, self.stiffness_factor)
        limit = self.friction * contact.normal_force
        size = ops.smooth_norm(
            linear.longitudinal, linear.lateral, RELATIVE_FLOOR * floored_limit(limit)
        )
        return scaled(linear, ops.minimum(1.0, limit / size))
