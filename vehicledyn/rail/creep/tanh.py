"""Creep law of the wheelset problem: linear forces, each bent by a hyperbolic tangent."""

from __future__ import annotations

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.rail.creep.creep_law import (
    RELATIVE_FLOOR,
    CreepContact,
    CreepForces,
    CreepLaw,
    floored_limit,
    linear_forces,
)
from vehicledyn.rail.creep.kalker import CreepCoefficients
from vehicledyn.symbolic import ops


@register("creep", "tanh")
class Tanh(CreepLaw):
    """Linear forces with given coefficients, each bent by a hyperbolic tangent.

    F_x = -μ N tanh(G c² C11 ξ/(μ N)),    F_y = -μ N tanh((G c² C22 η + G c³ C23 φ)/(μ N)),

    and both scaled back where together they exceed μ N. No spin moment. The coefficients do not
    depend on the shape of the contact: the law of the wheelset problem of the Test Set for IVP
    Solvers. Creepages there refer to the mean of travelling and rolling speed.

    References
    ----------
    Simeon, Führer, Rentrop (1991), Introduction to differential-algebraic equations in vehicle
    system dynamics, Surveys on Mathematics for Industry 1, 1-37; the form of the saturation by
    Jaschinski (1990), DLR-FB 90-06.
    """

    c11: float = quantity("1", "Kalker's C11 of the contact", gt=0)
    c22: float = quantity("1", "Kalker's C22 of the contact", gt=0)
    c23: float = quantity("1", "Kalker's C23 of the contact", ge=0)

    def forces(self, contact: CreepContact) -> CreepForces:
        """Return the forces; the spin moment is zero."""
        kalker = CreepCoefficients(self.c11, self.c22, self.c23, 0.0)
        linear = linear_forces(contact, kalker, self.stiffness_factor)
        limit = self.friction * contact.normal_force
        floor = floored_limit(limit)
        x = ops.tanh(linear.longitudinal / floor)
        y = ops.tanh(linear.lateral / floor)
        kept = limit / ops.maximum(1.0, ops.smooth_norm(x, y, RELATIVE_FLOOR))
        return CreepForces(kept * x, kept * y, 0.0)
