"""Reece's soil."""

from __future__ import annotations

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.soils.soil import Soil, power
from vehicledyn.symbolic.ops import Scalar


@register("soil", "reece")
class Reece(Soil):
    """Pressure p = (c k'_c + γ b k'_φ)(z/b)ⁿ under a plate of the width b.

    References
    ----------
    A.R. Reece, Principles of soil-vehicle mechanics, Proc. Institution of Mechanical Engineers
    180 (1965), 45-66.
    """

    cohesive_factor: float = quantity("1", "k'_c", ge=0)
    frictional_factor: float = quantity("1", "k'_φ", ge=0)
    unit_weight: float = quantity("N/m^3", "Weight γ of the soil over its volume", gt=0)

    def pressure(self, sinkage: Scalar) -> Scalar:
        """Return the pressure at a sinkage; see :meth:`Soil.pressure`."""
        width = self.wheel_width
        modulus = (
            self.cohesion * self.cohesive_factor + self.unit_weight * width * self.frictional_factor
        )
        return modulus * power(sinkage / width, self.exponent)
