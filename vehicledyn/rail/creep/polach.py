"""Creep law of Polach: closed form with spin, falling friction and softer creep at large slip."""

from __future__ import annotations

import math

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.rail.creep.creep_law import (
    RELATIVE_FLOOR,
    CreepContact,
    CreepForces,
    CreepLaw,
    floored_limit,
)
from vehicledyn.rail.creep.kalker import CreepCoefficients, creep_coefficients
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

CREEP_FLOOR = 1e-7
"""Creepage that keeps magnitudes off zero, for division [1]."""

LINEAR_BELOW = 1e-7
"""Creepage below which each direction has the stiffness of the linear theory, if not given [1]."""


@register("creep", "polach")
class Polach(CreepLaw):
    """Law of Polach.

    With s_yC = η or η + φ a, whichever is larger, s_C = √(ξ² + s_yC²), s = √(ξ² + η²),

    C = √((C11 ξ/s)² + (C22 η/s)²),    ε = G π a b C s_C / (4 μ N),

    F = 2 μ N/π (k_A ε/(1 + (k_A ε)²) + atan(k_S ε)),    F_x = -F ξ/s_C,    F_y = -F η/s_C + F_S,

    and the side force of spin, with κ = 1 + 6.3 (1 - exp(-a/b)),

    F_S = 9/16 a μ N κ K φ/s_C,    K = ε_S (δ³/3 - δ²/2 + 1/6) - 1/3 (1 - δ²)^(3/2),

    δ = (ε_S² - 1)/(ε_S² + 1),    ε_S = 8/3 G C23 b √(a b) |s_yC| / (κ μ N),

    with which F_S opposes the spin (K is negative). Friction falls with the sliding speed
    w = V s: μ = μ₀ ((1 - A) exp(-B w) + A). Without A, B, k_A, k_S the law is that of 1999. The
    sum is cut off at μ N. No spin moment. Without spin within some 10 % of μ N of the exact
    solution; with it, see the validation table.

    C depends on the direction of creep, however small, so that F has no slope at zero creep. Here
    F_x has C_x² = ((C11 ξ)² + (C22 η)² + s_0² C11²)/(s² + s_0²), F_y the same with C22 at the end:
    below s_0 = linear_below the slopes are those of the linear theory, far above it nothing
    changes. Between s_0 and sliding, forces do not superpose: those of a creepage askew differ by
    up to a tenth from the sum of those of its components, at any size.
    Where s_yC passes from one of its values to the other, at η = -φ a/2, slopes change abruptly.

    References
    ----------
    Polach (1999), A fast wheel-rail forces calculation computer code, Vehicle System Dynamics 33
    (Suppl.), 728-739; Polach (2005), Creep forces in simulations of traction vehicles running on
    adhesion limit, Wear 258, 992-1000.
    """

    adhesion_reduction: float = quantity(
        "1", "k_A, reduces the stiffness where the contact adheres", default=1.0, gt=0, le=1
    )
    slip_reduction: float = quantity(
        "1", "k_S, reduces it where the contact slides, at most k_A", default=1.0, gt=0, le=1
    )
    friction_ratio: float = quantity(
        "1", "A, friction at infinite sliding speed over that at none", default=1.0, gt=0, le=1
    )
    friction_decay: float = quantity("s/m", "B, decay of friction with speed", default=0.0, ge=0)
    linear_below: float = quantity(
        "1",
        "Creepage below which forces are those of the linear theory",
        default=LINEAR_BELOW,
        gt=0,
        le=1e-2,
    )

    @property
    def bends_at_rest(self) -> str:
        """Why its forces are not linear in small creepages."""
        return (
            "its stiffness depends on the direction of creepage down to creepages of "
            f"{self.linear_below:g}, below which it is that of the linear theory; 'linear_below' "
            "of the law changes that limit"
        )

    def forces(self, contact: CreepContact) -> CreepForces:
        """Return the forces; the spin moment is zero."""
        xi, eta = contact.longitudinal, contact.lateral
        slip = ops.smooth_norm(xi, eta, CREEP_FLOOR)
        limit = self._friction(contact.speed * slip) * contact.normal_force
        floor = floored_limit(limit)
        moved = eta + contact.spin * contact.ellipse.semi_axis_x
        larger = ops.maximum(eta * eta, moved * moved)
        across = ops.sqrt(larger + CREEP_FLOOR * CREEP_FLOOR)
        whole = ops.sqrt(xi * xi + across * across)
        kalker = creep_coefficients(contact.axis_ratio, contact.poissons_ratio)
        stiffness = self.stiffness_factor * contact.shear_modulus * contact.area_scale / floor
        along, aside = (stiffness * c * whole for c in _joined(kalker, xi, eta, self.linear_below))
        side = _spin_part(contact, stiffness * kalker.lateral_spin * across)
        x = -limit * self._creep_part(along) * xi / whole
        y = -limit * (self._creep_part(aside) * eta + side * contact.spin) / whole
        size = ops.smooth_norm(x, y, RELATIVE_FLOOR * floor)
        kept = ops.minimum(1.0, limit / size)
        return CreepForces(kept * x, kept * y, 0.0)

    def _friction(self, sliding_speed: Scalar) -> Scalar:
        fallen = (1.0 - self.friction_ratio) * ops.exp(-self.friction_decay * sliding_speed)
        return self.friction * (fallen + self.friction_ratio)

    def _creep_part(self, relative: Scalar) -> Scalar:
        """Return F / (μ N) for G a b C s_C / (μ N)."""
        epsilon = 0.25 * math.pi * relative
        adhering = self.adhesion_reduction * epsilon
        return (2.0 / math.pi) * (
            adhering / (1.0 + adhering * adhering) + ops.atan(self.slip_reduction * epsilon)
        )


def _joined(
    kalker: CreepCoefficients, xi: Scalar, eta: Scalar, floor: float
) -> tuple[Scalar, Scalar]:
    """Return C of the forces along and across, between C11 and C22 as the creepage points."""
    x, y = kalker.longitudinal * xi, kalker.lateral * eta
    square = floor * floor
    rest = 1.0 / (xi * xi + eta * eta + square)
    mixed = x * x + y * y
    along, across = (
        ops.sqrt((mixed + square * c * c) * rest) for c in (kalker.longitudinal, kalker.lateral)
    )
    return along, across


def _spin_part(contact: CreepContact, relative: Scalar) -> Scalar:
    """Return -F_S s_C/(μ N φ) [m] for G a b C23 |s_yC| / (μ N)."""
    a, b = contact.ellipse.semi_axis_x, contact.ellipse.semi_axis_y
    kappa = 1.0 + 6.3 * (1.0 - ops.exp(-a / b))
    # 8/3 b √(ab) over ab is 8/3 √(b/a).
    epsilon = 8.0 / 3.0 * ops.sqrt(b / a) * relative / kappa
    square = epsilon * epsilon
    delta = (square - 1.0) / (square + 1.0)
    # 1 - δ² = 4 ε²/(ε² + 1)², so that its power has a slope at zero.
    root = 2.0 * epsilon / (square + 1.0)
    bracket = delta * delta * (delta / 3.0 - 0.5) + 1.0 / 6.0
    return -9.0 / 16.0 * a * kappa * (epsilon * bracket - root * root * root / 3.0)
