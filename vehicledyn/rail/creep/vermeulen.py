"""Creep factors of Vermeulen and Johnson for any ratio of the contact's axes."""

from __future__ import annotations

import math

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

ITERATIONS = 6
"""Steps of the arithmetic-geometric mean: exact to rounding for a/b from 1e-3 to 1e3."""


def vermeulen_factors(axis_ratio: Scalar, poissons_ratio: Scalar) -> tuple[Scalar, Scalar]:
    """Return φ and ψ of Vermeulen and Johnson.

    φ = (1 - ν) B + ν s² C,    ψ = B - ν s² C,    s = a/b, m = 1 - s²,

    B = ∫ cos²t/Δ dt,    C = ∫ sin²t cos²t/Δ³ dt,    Δ² = 1 - m sin²t, t from 0 to π/2. For s < 1
    B and C are the complete elliptic integrals that the source tabulates; for s > 1 the same
    integrals hold, with negative m, which spares the source's second set of formulas. They follow
    from tractions ∝ √(1 - x²/a² - y²/b²) on half-spaces; for a = b, φ = π/4 (1 - 3ν/4) and
    ψ = π/4 (1 - ν/4), Johnson's values.

    Parameters
    ----------
    axis_ratio
        a/b, a in the rolling direction, positive [1].
    poissons_ratio
        ν [1].
    """
    b, c = _integrals(axis_ratio)
    shear = poissons_ratio * axis_ratio * axis_ratio * c
    return (1.0 - poissons_ratio) * b + shear, b - shear


def _integrals(s: Scalar) -> tuple[Scalar, Scalar]:
    """Return B and C, by K, D = (K - E)/m, B = K - D, C = (2D - K)/m.

    c_n² of the arithmetic-geometric mean are taken over m and m², so that nothing is lost at
    s = 1, where m is zero.
    """
    mean, geometric = 0.5 * (1.0 + s), ops.sqrt(s)
    c_squared = 0.25 * (1.0 - s) * (1.0 - s)
    over_m = 0.25 * (1.0 - s) / (1.0 + s)
    over_m2: Scalar = 0.25 / ((1.0 + s) * (1.0 + s))
    first: Scalar = 0.5 + over_m
    second: Scalar = 2.0 * over_m2
    weight = 1.0
    for _ in range(ITERATIONS - 1):
        weight *= 2.0
        mean, geometric = 0.5 * (mean + geometric), ops.sqrt(mean * geometric)
        # c_{n+1}² = c_n⁴ / (16 a_{n+1}²)
        shrink = 1.0 / (16.0 * mean * mean)
        over_m2 = over_m * over_m * shrink
        over_m, c_squared = over_m * c_squared * shrink, c_squared * c_squared * shrink
        first = first + weight * over_m
        second = second + 2.0 * weight * over_m2
    k = 0.5 * math.pi / mean
    return k * (1.0 - first), k * second
