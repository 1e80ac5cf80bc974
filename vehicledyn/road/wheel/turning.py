"""Turning on the spot: the moment of a contact patch whose bristles are twisted.

A patch of the half length a, with a parabolic pressure along a line, is twisted against the
ground by ψ'. Its bristles stick for |x| < s a and slide beyond, where they ask for more than
μ times the pressure. With λ = 2 K ψ'/(μ F_z a) and λ s = 1 - s²,

    M_z = -μ F_z a (λ s³/2 + 3/8 (1 - s²)²),

which begins with the slope K and approaches 3/8 μ F_z a. The twist grows with the rate ω_n at
which the wheel turns about the ground's normal, and rolls off:

    ψ'' = ω_n - |v_x| ψ'/a,

held back where λ exceeds LARGEST_TWIST, so that a wheel that turns back unloads its bristles at
once. At standstill the twist is a spring: a held steering wheel keeps its torque.
"""

from __future__ import annotations

from vehicledyn.base.parameters import ParameterSet, quantity
from vehicledyn.road.tyres.smooth import floored
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

LARGEST_TWIST = 12.0
"""λ up to which the twist grows: 99.5 % of the largest moment [1]."""

RELEASE_TIME = 0.01
"""Time in which more twist than that is lost [s]."""

LEAST_FORCE = 1.0
"""Friction force that twists are referred to at least; a wheel in the air has no moment [N]."""


class Turning(ParameterSet):
    """Moment about the ground's normal of a tyre that is turned on the spot.

    References
    ----------
    Pacejka (2012), Tire and Vehicle Dynamics, section 3.2: bristles of the brush model, here
    turned at rest; the moment was integrated over the patch.
    """

    half_length: float = quantity("m", "Half length a of the contact patch", gt=0)
    friction: float = quantity("1", "Friction coefficient μ of the patch", gt=0)
    stiffness: float = quantity(
        "N*m/rad", "Slope K of the moment; a third of cornering stiffness times a of bristles", gt=0
    )

    def moment(self, twist: Scalar, load: Scalar) -> Scalar:
        """Return M_z at a twist ψ' [rad] and a load [N]."""
        limit = floored(self.friction * load, LEAST_FORCE) * self.half_length
        share = ops.smooth_norm(2.0 * self.stiffness * twist / limit, 0.0, 1e-9)
        stuck = 2.0 / (share + ops.sqrt(share * share + 4.0))
        slid = 1.0 - stuck * stuck
        size = 0.5 * share * stuck * stuck * stuck + 0.375 * slid * slid
        largest = self.friction * ops.maximum(load, 0.0) * self.half_length
        return -largest * size * 2.0 * self.stiffness * twist / (limit * share)

    def rate(self, twist: Scalar, load: Scalar, turning: Scalar, speed: Scalar) -> Scalar:
        """Return the rate of the twist at ω_n [rad/s] and |v_x| [m/s]."""
        limit = floored(self.friction * load, LEAST_FORCE) * self.half_length
        kept = LARGEST_TWIST * limit / (2.0 * self.stiffness)
        excess = twist - ops.minimum(ops.maximum(twist, -kept), kept)
        return turning - speed * twist / self.half_length - excess / RELEASE_TIME
