"""Brush model of a tyre with a parabolic distribution of pressure, in closed form."""

from __future__ import annotations

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.tyres.smooth import floored
from vehicledyn.road.tyres.tyre import Tyre, TyreForces, TyreInput
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

SLIP_FLOOR = 1e-9
"""Rounds the magnitude of the slip at zero [1]."""

ROLLING_FLOOR = 0.02
"""Least 1 + κ that slips are referred to; a wheel that hardly turns slides altogether [1]."""

ANGLE_LIMIT = 1.5
"""Slip angle beyond which its tangent no longer grows [rad]."""


@register("tyre", "brush")
class Brush(Tyre):
    """Elastic bristles that slide where they ask for more than μ times a parabolic pressure.

    With the theoretical slip σ = (κ, tan α)/(1 + κ) and u = C |σ|/(3 μ F_0), at most one,

    F = μ F_z (1 - (1 - u)³) along σ,    M_z = μ F_z a u (1 - u)³ σ_y/|σ|.

    C is the slip stiffness at the nominal load F_0; the half length of the contact patch is
    a_0 √(F_z/F_0), so that stiffness and friction are in proportion to the load. Camber adds
    C_γ γ/C to σ_y. The law never gives energy while the camber is zero.

    References
    ----------
    Pacejka (2012), Tire and Vehicle Dynamics, section 3.2; checked by integration over the
    bristles.
    """

    nominal_load: float = quantity("N", "Load F_0 that stiffness and length refer to", gt=0)
    slip_stiffness: float = quantity("N", "Slope C of force over slip, in any direction", gt=0)
    half_length: float = quantity("m", "Half length a_0 of the contact patch", gt=0)
    friction: float = quantity("1", "Friction coefficient μ", gt=0)
    camber_stiffness: float = quantity("N/rad", "Slope C_γ of force over camber", default=0.0, ge=0)

    def forces(self, contact: TyreInput) -> TyreForces:
        """Return the forces in the direction of the slip, and the aligning moment."""
        angle = ops.minimum(ops.maximum(contact.slip_angle, -ANGLE_LIMIT), ANGLE_LIMIT)
        rolled = floored(1.0 + contact.longitudinal_slip, ROLLING_FLOOR)
        lean = self.camber_stiffness / self.slip_stiffness * contact.camber
        along, across = contact.longitudinal_slip / rolled, ops.tan(angle) / rolled + lean
        slip = ops.smooth_norm(along, across, SLIP_FLOOR)
        share = self.slip_stiffness * slip / (3.0 * self.friction * self.nominal_load)
        sliding = ops.minimum(share, 1.0)
        stuck = 1.0 - sliding
        limit = self.friction * contact.normal_force
        force = limit * sliding * (3.0 + sliding * (sliding - 3.0)) / slip
        moment = limit * self._half_length(contact.normal_force) * share * stuck * stuck * stuck
        return TyreForces(force * along, -force * across, moment * across / slip)

    def _half_length(self, load: Scalar) -> Scalar:
        return self.half_length * ops.sqrt(floored(load / self.nominal_load, 1e-3))
