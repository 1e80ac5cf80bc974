"""Hertz's contact of two elastic bodies: ellipse, approach, pressure and force from curvatures.

Near the contact point the gap of the undeformed bodies is A x² + B y² with half curvature sums
A, B > 0, x in the rolling direction. All lengths follow from ln(A/B) alone, see
:mod:`vehicledyn.rail.geometry.hertz_shape`, so x may be the long or the short axis of the ellipse
and nothing jumps where it changes. Everything here takes floats and expressions alike.

References
----------
Johnson (1985), Contact Mechanics, chapter 4; Kalker (1990), Three-Dimensional Elastic Bodies
in Rolling Contact.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from vehicledyn.rail.geometry.hertz_shape import ellipse_shape
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

CURVATURE_FLOOR = 1e-2
"""Least half curvature sum; more conforming bodies are taken as this open [1/m]."""

FORCE_FLOOR = 1e-6
"""Least force that an ellipse is computed for, so that its size has a slope at no force [N]."""

APPROACH_FLOOR = 1e-13
"""Least approach that an ellipse is computed for [m]."""


@dataclass(frozen=True)
class Hertz:
    """A Hertzian contact, as far as it depends on geometry and material alone.

    Attributes
    ----------
    semi_axis_x_factor, semi_axis_y_factor
        m and n: the semi-axes are m f and n f, f = [3 N / (4 E* (A + B))]^(1/3) [1].
    approach_factor
        r: the approach is r f² (A + B) [1].
    curvature_sum
        A + B [1/m].
    modulus
        E* [N/m²].
    """

    semi_axis_x_factor: Scalar
    semi_axis_y_factor: Scalar
    approach_factor: Scalar
    curvature_sum: Scalar
    modulus: Scalar

    def force(self, approach: Scalar) -> Scalar:
        """Return the normal force N of an approach δ, zero where the bodies are apart [N].

        N = 4/3 E* (δ/r)^(3/2) (A + B)^(-1/2)
        """
        relative = ops.maximum(approach, 0.0) / self.approach_factor
        # The root is kept off zero, where it has no slope.
        root = ops.sqrt(ops.maximum(relative, APPROACH_FLOOR) / self.curvature_sum)
        return 4.0 / 3.0 * self.modulus * relative * root

    def approach(self, normal_force: Scalar) -> Scalar:
        """Return the approach δ under a normal force, zero where it pulls [m]."""
        size = self._size(normal_force)
        pressed = ops.maximum(normal_force, 0.0) / ops.maximum(normal_force, FORCE_FLOOR)
        return self.approach_factor * size * size * self.curvature_sum * pressed

    def ellipse(self, normal_force: Scalar) -> ContactEllipse:
        """Return the ellipse under a normal force [N]; it shrinks to a point with the force."""
        return self._ellipse(self._size(normal_force))

    def ellipse_at(self, approach: Scalar) -> ContactEllipse:
        """Return the ellipse at an approach [m]."""
        lower = ops.maximum(approach, APPROACH_FLOOR)
        return self._ellipse(ops.sqrt(lower / (self.approach_factor * self.curvature_sum)))

    def _size(self, normal_force: Scalar) -> Scalar:
        """Return f [m]."""
        force = ops.maximum(normal_force, FORCE_FLOOR)
        return (0.75 * force / (self.modulus * self.curvature_sum)) ** (1.0 / 3.0)

    def _ellipse(self, size: Scalar) -> ContactEllipse:
        return ContactEllipse(self.semi_axis_x_factor * size, self.semi_axis_y_factor * size)


@dataclass(frozen=True)
class ContactEllipse:
    """Semi-axes of the contact, a in the rolling direction and b across it [m]."""

    semi_axis_x: Scalar
    semi_axis_y: Scalar

    def largest_pressure(self, normal_force: Scalar) -> Scalar:
        """Return the pressure 3 N / (2 π a b) in the middle of the ellipse [N/m²]."""
        return 1.5 * normal_force / (math.pi * self.semi_axis_x * self.semi_axis_y)


def hertz(curvature_x: Scalar, curvature_y: Scalar, modulus: Scalar) -> Hertz:
    """Return the contact of two bodies whose gap is A x² + B y².

    Parameters
    ----------
    curvature_x, curvature_y
        A and B, half sums of the bodies' curvatures along x and y, convex positive [1/m]. Values
        below ``CURVATURE_FLOOR`` (conforming bodies, which Hertz's theory does not cover) are
        taken as this floor; see :func:`is_hertzian`. Beyond A/B = 10⁻⁴ to 10⁴ the shape is that
        of the end of the range.
    modulus
        E* of both bodies, see :func:`effective_modulus` [N/m²].
    """
    a = ops.maximum(curvature_x, CURVATURE_FLOOR)
    b = ops.maximum(curvature_y, CURVATURE_FLOOR)
    shape = ellipse_shape(a / b)
    return Hertz(shape.semi_axis_x, shape.semi_axis_y, shape.approach, a + b, modulus)


def is_hertzian(curvature_x: float, curvature_y: float) -> bool:
    """Return whether half curvature sums A, B [1/m] are within what :func:`hertz` covers."""
    return min(curvature_x, curvature_y) >= CURVATURE_FLOOR and (
        1e-4 <= curvature_x / curvature_y <= 1e4
    )


def effective_modulus(
    youngs_modulus: Scalar,
    poissons_ratio: Scalar,
    other_youngs_modulus: Scalar,
    other_poissons_ratio: Scalar,
) -> Scalar:
    """Return E* of two elastic bodies, 1/E* = (1 - ν₁²)/E₁ + (1 - ν₂²)/E₂ [N/m²]."""
    one = (1.0 - poissons_ratio * poissons_ratio) / youngs_modulus
    other = (1.0 - other_poissons_ratio * other_poissons_ratio) / other_youngs_modulus
    return 1.0 / (one + other)
