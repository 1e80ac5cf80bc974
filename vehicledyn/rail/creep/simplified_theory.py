"""Kalker's simplified theory of rolling contact: tractions along strips of the contact ellipse.

In each strip across y a particle enters at the leading edge x = l(y) without traction and
collects, in units of a, b and the pressure bound 2 μ N/(π a b),

dp_x/dx = ξ/L1 - φ b y/L3,    dp_y/dx = η/L2 + φ a x/L3,    |p| ≤ l² - x²,

where a traction beyond the bound is brought back to it in its own direction. Kalker takes equal
strips and elements. Here the strips are equal in θ, y = sin θ, and the elements end at Gauss's
points of the strip, so that the sums over them are exact where all slides and (to 2e-4 for ten
strips) where all adheres; in between the error falls in proportion to the number of elements.

Three unequal flexibilities turn the sliding traction away from the slip, which is the rigid
one, (ξ - φ b y, η + φ a x), where creep is large. A second set of rates is therefore followed to
the part that the traction has of its bound, to the fourth power: with one flexibility, the
geometric mean, for all three (:func:`sliding_rates`), or the same rates again, as published.

Flexibilities: L1 = 8 a/(3 G C11), L2 = 8 a/(3 G C22), L3 = π a √(a/b)/(4 G C23).

References
----------
Kalker (1982), A fast algorithm for the simplified theory of rolling contact, Vehicle System
Dynamics 11, 1-13.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from vehicledyn.rail.creep.creep_law import CreepContact, CreepForces
from vehicledyn.rail.creep.kalker import creep_coefficients
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

TRACTION_FLOOR = 1e-9
"""Rounds the magnitude of tractions over the largest bound where they vanish [1]."""


@dataclass(frozen=True)
class Rates:
    """Growth of the tractions along a strip, per length a and over the pressure bound [1].

    Attributes
    ----------
    longitudinal, lateral
        a ξ/L1 and a η/L2.
    spin_along, spin_across
        a b φ/L3 (for p_x at y = 1) and a² φ/L3 (for p_y at x = 1).
    """

    longitudinal: Scalar
    lateral: Scalar
    spin_along: Scalar
    spin_across: Scalar


@dataclass(frozen=True)
class Sums:
    """Forces over μ N, and the two parts of the spin moment, over μ N a and μ N b [1]."""

    longitudinal: Scalar
    lateral: Scalar
    moment_of_lateral: Scalar
    moment_of_longitudinal: Scalar


def rates_of(contact: CreepContact, limit: Scalar, factor: Scalar = 1.0) -> Rates:
    """Return the growth of the tractions for a friction force μ N that is not zero [N]."""
    kalker = creep_coefficients(contact.axis_ratio, contact.poissons_ratio)
    a, b = contact.ellipse.semi_axis_x, contact.ellipse.semi_axis_y
    stiffness = factor * contact.shear_modulus * a * b / limit
    across = 2.0 * stiffness * kalker.lateral_spin * ops.sqrt(a * b) * contact.spin
    straight = 3.0 * math.pi / 16.0 * stiffness
    return Rates(
        straight * kalker.longitudinal * contact.longitudinal,
        straight * kalker.lateral * contact.lateral,
        across * b / a,
        across,
    )


def sliding_rates(contact: CreepContact, limit: Scalar, factor: Scalar = 1.0) -> Rates:
    """Return the growth of tractions by one flexibility, the geometric mean of the three."""
    kalker = creep_coefficients(contact.axis_ratio, contact.poissons_ratio)
    a, b = contact.ellipse.semi_axis_x, contact.ellipse.semi_axis_y
    straight = 3.0 * math.pi / 16.0
    spin = 2.0 * kalker.lateral_spin * ops.sqrt(b / a)
    product = straight * kalker.longitudinal * straight * kalker.lateral * spin
    common = factor * contact.shear_modulus * a * b / limit * product ** (1.0 / 3.0)
    return Rates(
        common * contact.longitudinal,
        common * contact.lateral,
        common * b * contact.spin,
        common * a * contact.spin,
    )


def total(contact: CreepContact, limit: Scalar, sums: Sums) -> CreepForces:
    """Return the forces of the sums, for a friction force μ N [N]."""
    ellipse = contact.ellipse
    moment = ellipse.semi_axis_x * sums.moment_of_lateral
    moment = moment - ellipse.semi_axis_y * sums.moment_of_longitudinal
    return CreepForces(limit * sums.longitudinal, limit * sums.lateral, limit * moment)


def march(rates: Rates, sliding: Rates, strips: int, elements: int) -> Sums:
    """Return the sums of the tractions over the ellipse, of numbers or expressions.

    Parameters
    ----------
    rates, sliding
        What the tractions grow by where they are small, and where they reach their bound.
    strips, elements
        Number of strips and of elements in each, at least 2.
    """
    totals: list[Scalar] = [0.0, 0.0, 0.0, 0.0]
    for y, half_length, width in _strips(strips):
        for k, part in enumerate(_strip(ops, (rates, sliding), y, half_length, elements)):
            totals[k] = totals[k] + width * part
    return Sums(*totals)


def march_arrays(rates: Rates, sliding: Rates, strips: int, elements: int) -> Sums:
    """Return what :func:`march` does for rates that are arrays of one shape, by NumPy."""
    import numpy as np

    y, half_length, width = np.array(_strips(strips)).T
    both = _columns(rates), _columns(sliding)
    return Sums(*(part @ width for part in _strip(np, both, y, half_length, elements)))


def _columns(rates: Rates) -> Rates:
    """Return rates with a last axis for the strips."""
    import numpy as np

    return Rates(*(np.asarray(rate)[..., None] for rate in vars(rates).values()))


def _strips(count: int) -> list[tuple[float, float, float]]:
    """Return y, half length and width, over the sum of all bounds, of each strip."""
    angles = [math.pi * ((k + 0.5) / count - 0.5) for k in range(count)]
    # The strip is cos θ π/n wide, and 2/π turns the sum into parts of μ N.
    return [(math.sin(t), math.cos(t), 2.0 / count * math.cos(t)) for t in angles]


def _strip(
    library: Any, both: tuple[Rates, Rates], y: Scalar, half_length: Scalar, elements: int
) -> tuple[Scalar, Scalar, Scalar, Scalar]:
    """Return ∫ p_x, ∫ p_y, ∫ x p_y, ∫ y p_x along a strip, or along an array of strips."""
    rates, sliding = both
    along = rates.longitudinal - rates.spin_along * y
    sliding_along = sliding.longitudinal - sliding.spin_along * y
    px: Scalar = 0.0
    py: Scalar = 0.0
    sums: list[Scalar] = [0.0, 0.0, 0.0]
    before = half_length
    for node, weight in gauss(elements):
        x = half_length * node
        step, mean = before - x, 0.5 * (before + x)
        bound = half_length**2 - x * x
        across = rates.lateral + rates.spin_across * mean
        # Adhesion takes the mean rate over the element, sliding the one at its end.
        grown = (px - along * step) ** 2 + (py - across * step) ** 2
        share = library.minimum(1.0, grown / bound**2) ** 2
        sliding_across = sliding.lateral + sliding.spin_across * x
        px = px - (along + share * (sliding_along - along)) * step
        py = py - (across + share * (sliding_across - across)) * step
        size = library.sqrt(px * px + py * py + TRACTION_FLOOR**2)
        kept = library.minimum(1.0, bound / size)
        px, py, before = px * kept, py * kept, x
        width = half_length * weight
        for k, part in enumerate((px, py, x * py)):
            sums[k] = sums[k] + width * part
    return sums[0], sums[1], sums[2], y * sums[0]


@lru_cache(maxsize=32)
def gauss(count: int) -> tuple[tuple[float, float], ...]:
    """Return Gauss's points between 1 and -1, from the leading edge on, and their weights."""
    import numpy as np

    nodes, weights = np.polynomial.legendre.leggauss(count)
    return tuple((float(x), float(w)) for x, w in zip(nodes[::-1], weights[::-1], strict=True))
