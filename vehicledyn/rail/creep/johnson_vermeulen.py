"""Creep law of Vermeulen and Johnson, without spin."""

from __future__ import annotations

import math

from vehicledyn.base.registry import register
from vehicledyn.rail.creep.creep_law import CreepContact, CreepForces, CreepLaw
from vehicledyn.rail.creep.cubic_saturation import cubic_part
from vehicledyn.rail.creep.vermeulen import vermeulen_factors
from vehicledyn.symbolic.ops import Scalar


@register("creep", "johnson_vermeulen")
class JohnsonVermeulen(CreepLaw):
    """Law of Vermeulen and Johnson, with their own creep coefficients and no spin.

    F = -μ N (1 - (1 - τ/3)³) t/τ for τ < 3 and μ N beyond, with t = (π a b G/(μ N)) (ξ/φ, η/ψ),
    τ = |t| and φ, ψ of :func:`vehicledyn.rail.creep.vermeulen.vermeulen_factors`. The adhesion
    region
    is an ellipse that touches the leading edge, which makes the law 10 to 30 % stiffer at small
    creep than the exact solution. Spin has no effect, and there is no spin moment.

    References
    ----------
    Vermeulen, Johnson (1964), Contact of nonspherical elastic bodies transmitting tangential
    forces, J. Appl. Mech. 31(2), 338-340.
    """

    def forces(self, contact: CreepContact) -> CreepForces:
        """Return the forces; the spin moment is zero."""
        limit = self.friction * contact.normal_force
        x, y = self._linear(contact)
        part = cubic_part(x, y, limit)
        return CreepForces(part * x, part * y, 0.0)

    def _linear(self, contact: CreepContact) -> tuple[Scalar, Scalar]:
        phi, psi = vermeulen_factors(contact.axis_ratio, contact.poissons_ratio)
        stiffness = self.stiffness_factor * contact.shear_modulus * contact.area_scale
        return (
            -math.pi * stiffness * contact.longitudinal / phi,
            -math.pi * stiffness * contact.lateral / psi,
        )
