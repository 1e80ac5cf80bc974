"""Shape of Hertz's ellipse against the ratio of curvatures, exactly and as smooth functions.

With g the ratio of the axes, k² = 1 - g² and the complete elliptic integrals K, E of modulus k,
the curvature ratio is A/B = (K - E) g² / (E - g² K), and

m = (2E / (π g²))^(1/3),    n = g m,    r = 2K / (π m).

ln(a/b) is an odd function of l = ln(A/B), r and ab are even ones, so that they are polynomials
in t = l²/(l² + 49), which need no case for a < b. Their deviation from the elliptic integrals
is below 1e-7, relative, for 1e-4 ≤ A/B ≤ 1e4. The polynomials are derived from the integrals
when first used.

References
----------
Johnson (1985), Contact Mechanics, section 4.2; Abramowitz, Stegun (1964), section 17.6 (the
arithmetic-geometric mean).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

LARGEST_RATIO = 1e4
"""A/B and B/A are held below this [1]."""

DEGREE = 13
_SPREAD = 49.0
_FURTHEST = math.log(LARGEST_RATIO) ** 2
_T_LARGEST = _FURTHEST / (_FURTHEST + _SPREAD)


@dataclass(frozen=True)
class EllipseShape:
    """The factors m, n of the semi-axes along x and y, and r of the approach [1]."""

    semi_axis_x: Scalar
    semi_axis_y: Scalar
    approach: Scalar


def ellipse_shape(curvature_ratio: Scalar) -> EllipseShape:
    """Return the shape for A/B, the curvature along x over that along y, held in its range."""
    held = ops.minimum(ops.maximum(curvature_ratio, 1.0 / LARGEST_RATIO), LARGEST_RATIO)
    logarithm = ops.log(held)
    square = logarithm * logarithm
    z = 2.0 * square / ((square + _SPREAD) * _T_LARGEST) - 1.0
    slope, half_area, approach = (_horner(c, z) for c in _polynomials())
    # m = √(mn) √(m/n), where m/n = a/b is (A/B)^-slope.
    half = ops.exp(-0.5 * slope * logarithm)
    return EllipseShape(half_area * half, half_area / half, approach)


def exact_shape(axis_ratio: float) -> tuple[float, EllipseShape]:
    """Return A/B and the shape of an ellipse with given g = b/a ≤ 1, from elliptic integrals."""
    k, difference = _integrals(axis_ratio)
    e = k - difference
    square = axis_ratio * axis_ratio
    m = (2.0 * e / (math.pi * square)) ** (1.0 / 3.0)
    # E - g² K = k² K - (K - E), which loses no digits for slender ellipses.
    rest = (1.0 - square) * k - difference
    shape = EllipseShape(m, axis_ratio * m, 2.0 * k / (math.pi * m))
    return (square * difference / rest if rest > 0.0 else 1.0), shape


def _integrals(axis_ratio: float) -> tuple[float, float]:
    """Return K and K - E of modulus √(1 - g²) by the arithmetic-geometric mean."""
    a, b = 1.0, axis_ratio
    total, weight = 0.5 * (1.0 - axis_ratio * axis_ratio), 0.5
    while abs(a - b) > 1e-16 * a:
        weight *= 2.0
        total += weight * (0.5 * (a - b)) ** 2
        a, b = 0.5 * (a + b), math.sqrt(a * b)
        if weight > 1e3:
            break
    k = math.pi / (2.0 * a)
    return k, k * total


@lru_cache(maxsize=1)
def _polynomials() -> tuple[tuple[float, ...], ...]:
    """Return the coefficients in z, lowest first, of ln(a/b)/(-l), √(mn) and r."""
    count = DEGREE + 1
    nodes = [math.cos(math.pi * (i + 0.5) / count) for i in range(count)]
    values = [_at(z) for z in nodes]
    return tuple(_interpolate(nodes, [v[k] for v in values]) for k in range(3))


def _at(z: float) -> tuple[float, float, float]:
    t = 0.5 * (z + 1.0) * _T_LARGEST
    logarithm = math.sqrt(_SPREAD * t / (1.0 - t))
    low, high = 1e-9, 1.0
    for _ in range(100):
        middle = math.sqrt(low * high)
        low, high = (
            (middle, high) if exact_shape(middle)[0] < math.exp(-logarithm) else (low, middle)
        )
    g = math.sqrt(low * high)
    _, shape = exact_shape(g)
    slope = -math.log(g) / logarithm
    return slope, math.sqrt(shape.semi_axis_x * shape.semi_axis_y), shape.approach


def _interpolate(nodes: list[float], values: list[float]) -> tuple[float, ...]:
    """Return the coefficients of the polynomial through values at Chebyshev's nodes."""
    count = len(nodes)
    before, chebyshev = [1.0] + [0.0] * (count - 1), [0.0, 1.0] + [0.0] * (count - 2)
    total = [sum(values) / count] + [0.0] * (count - 1)
    for degree in range(1, count):
        weights = [math.cos(degree * math.acos(z)) for z in nodes]
        factor = 2.0 / count * sum(w * v for w, v in zip(weights, values, strict=True))
        total = [s + factor * c for s, c in zip(total, chebyshev, strict=True)]
        shifted = [0.0, *chebyshev[:-1]]
        before, chebyshev = chebyshev, [2.0 * s - b for s, b in zip(shifted, before, strict=True)]
    return tuple(total)


def _horner(coefficients: tuple[float, ...], z: Scalar) -> Scalar:
    total: Scalar = coefficients[-1]
    for coefficient in reversed(coefficients[:-1]):
        total = total * z + coefficient
    return total
