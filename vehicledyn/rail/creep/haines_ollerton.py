"""Strip theory of Haines and Ollerton: cylinders side by side, each with Carter's traction."""

from __future__ import annotations

import math

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

SLIDING = 1.0 - 1e-9
"""Slip depth from which all strips count as sliding; the force is there to rounding [1]."""


@register("creep", "haines_ollerton")
class HainesOllerton(CreepLaw):
    """Kalker's linear forces, spin included, bent as by the strips of an elliptical contact.

    Each strip slides over the same depth d at its trailing edge and sticks ahead of it, as
    Carter's cylinders do. Summed over the ellipse, with D = d/a and t = √(1 - D²), the force is

    F = μ N (1 + (3/2) (D arccos D - t + t³/3)),

    in the direction of F_linear. D = 4 |F_linear|/(3 π μ N) gives small creep Kalker's slope; from
    D = 1 on all strips slide. The spin moment is reduced in the same proportion.

    References
    ----------
    Haines, Ollerton (1963), Contact stress distributions on elliptical contact surfaces subjected
    to radial and tangential forces, Proc. Instn. Mech. Engrs. 177, 95-114; summed in closed form
    here.
    """

    def forces(self, contact: CreepContact) -> CreepForces:
        """Return the bent linear forces."""
        linear = kalker_forces(contact, self.stiffness_factor)
        limit = self.friction * contact.normal_force
        floor = floored_limit(limit)
        relative = ops.smooth_norm(
            linear.longitudinal / floor, linear.lateral / floor, RELATIVE_FLOOR
        )
        depth = ops.minimum(4.0 / (3.0 * math.pi) * relative, SLIDING)
        stuck = ops.sqrt(1.0 - depth * depth)
        angle = 0.5 * math.pi - ops.atan2(depth, stuck)
        bent = 1.0 + 1.5 * (depth * angle - stuck + stuck * stuck * stuck / 3.0)
        return scaled(linear, bent / relative * (limit / floor))
