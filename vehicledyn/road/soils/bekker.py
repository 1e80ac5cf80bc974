"""Bekker's soil."""

from __future__ import annotations

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.soils.soil import Soil, power
from vehicledyn.symbolic.ops import Scalar


@register("soil", "bekker")
class Bekker(Soil):
    """Pressure p = (k_c/b + k_φ) zⁿ under a plate of the width b.

    References
    ----------
    M.G. Bekker, Introduction to Terrain-Vehicle Systems, University of Michigan Press 1969.
    The moduli have units that depend on n; they are given here as the pressure's at a sinkage
    of 1 m: k_c in Pa m, k_φ in Pa.
    """

    cohesive_modulus: float = quantity("N/m", "k_c, for a sinkage of 1 m", ge=0)
    frictional_modulus: float = quantity("Pa", "k_φ, for a sinkage of 1 m", gt=0)

    def pressure(self, sinkage: Scalar) -> Scalar:
        """Return the pressure at a sinkage; see :meth:`Soil.pressure`."""
        modulus = self.cohesive_modulus / self.wheel_width + self.frictional_modulus
        return modulus * power(sinkage, self.exponent)
