"""Linear tyre: forces proportional to slip, bent towards the friction limit."""

from __future__ import annotations

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.tyres.tyre import Tyre, TyreForces, TyreInput
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

SLIP_FLOOR = 1e-6
"""Rounds the magnitude of the relative force at zero slip [1]."""


@register("tyre", "linear")
class Linear(Tyre):
    """Force linear in slip up to half the friction limit.

    With the relative forces f_x = C_κ κ/(μ F_0), f_y = -(C_α α + C_γ γ)/(μ F_0) and
    ρ = √(f_x² + f_y²), the force is μ F_z s(ρ)/ρ (f_x, f_y) with

    s = ρ for ρ ≤ 1/2,    ρ - (ρ - 1/2)²/2 up to 3/2,    1 beyond,

    so it is proportional to the load F_z and never exceeds μ F_z in any direction. The
    aligning moment is -trail · F_y, with the trail fading as the tyre slides: trail · s/ρ.
    """

    nominal_load: float = quantity("N", "Load F_0 that the stiffnesses refer to", gt=0)
    longitudinal_stiffness: float = quantity("N", "Slope C_κ of force over slip", ge=0)
    cornering_stiffness: float = quantity("N/rad", "Slope C_α of force over slip angle", ge=0)
    camber_stiffness: float = quantity("N/rad", "Slope C_γ of force over camber", default=0.0, ge=0)
    trail: float = quantity("m", "Pneumatic trail at small slip", default=0.0, ge=0)
    friction: float = quantity("1", "Friction coefficient μ", gt=0)

    def forces(self, contact: TyreInput) -> TyreForces:
        """Return the saturated forces and the aligning moment."""
        limit = self.friction * self.nominal_load
        along = self.longitudinal_stiffness * contact.longitudinal_slip / limit
        side = self.cornering_stiffness * contact.slip_angle
        across = -(side + self.camber_stiffness * contact.camber) / limit
        part = _saturation(ops.smooth_norm(along, across, SLIP_FLOOR))
        scale = self.friction * contact.normal_force * part
        lateral = scale * across
        return TyreForces(scale * along, lateral, -self.trail * part * lateral)


def _saturation(relative: Scalar) -> Scalar:
    """Return s(ρ)/ρ of a positive ρ."""
    over = ops.minimum(ops.maximum(relative - 0.5, 0.0), 1.0)
    reached = ops.minimum(relative, 1.5) - 0.5 * over * over
    return reached / relative
