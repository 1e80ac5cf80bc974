"""Dugoff's tyre: combined slip from two slip stiffnesses and a friction coefficient."""

from __future__ import annotations

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.tyres.smooth import floored
from vehicledyn.road.tyres.tyre import Tyre, TyreForces, TyreInput
from vehicledyn.symbolic import ops

FORCE_FLOOR = 1e-2
"""Rounds the magnitude of the linear force at zero [N]."""

ROLLING_FLOOR = 0.02
"""Least 1 + κ that slips are referred to; a wheel that hardly turns slides altogether [1]."""

ANGLE_LIMIT = 1.5
"""Slip angle beyond which its tangent no longer grows [rad]."""


@register("tyre", "dugoff")
class Dugoff(Tyre):
    """Linear forces of the slip, bent towards friction as by bristles under uniform pressure.

    With the slip (κ, tan α)/(1 + κ), the linear force P = (C_κ κ, -C_α tan α)/(1 + κ) and
    λ = μ F_z/(2 |P|), the force is

    F = P λ (2 - λ) for λ < 1, and P beyond.

    With C_κ = C_α this is exact for bristles under uniform pressure that slide where they ask for
    more than friction. The law has no peak, no moment and no camber.

    References
    ----------
    Dugoff, Fancher, Segel (1970), An analysis of tire traction properties and their influence on
    vehicle dynamic performance, SAE 700377, with constant friction; checked by summing over
    bristles.
    """

    longitudinal_stiffness: float = quantity("N", "Slope C_κ of force over slip", gt=0)
    cornering_stiffness: float = quantity("N/rad", "Slope C_α of force over slip angle", gt=0)
    friction: float = quantity("1", "Friction coefficient μ", gt=0)

    def forces(self, contact: TyreInput) -> TyreForces:
        """Return the linear forces, reduced together."""
        angle = ops.minimum(ops.maximum(contact.slip_angle, -ANGLE_LIMIT), ANGLE_LIMIT)
        rolled = floored(1.0 + contact.longitudinal_slip, ROLLING_FLOOR)
        along = self.longitudinal_stiffness * contact.longitudinal_slip / rolled
        across = self.cornering_stiffness * ops.tan(angle) / rolled
        size = ops.smooth_norm(along, across, FORCE_FLOOR)
        part = ops.minimum(self.friction * contact.normal_force / (2.0 * size), 1.0)
        share = part * (2.0 - part)
        return TyreForces(share * along, -share * across, 0.0)
