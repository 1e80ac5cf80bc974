"""What a soil is: its pressure under a sinking plate and its shear strength."""

from __future__ import annotations

import math
from abc import abstractmethod

from vehicledyn.base.parameters import ParameterSet, quantity
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


class Soil(ParameterSet):
    """Soil that yields under a wheel; every soil of the catalogue derives from it.

    Shear stress after Janosi and Hanamoto, τ = (c + σ tan φ)(1 - exp(-j/K)) with the shear
    displacement j. The place of the largest pressure under a wheel after Wong and Reece,
    θ_m = (c_1 + c_2 s) θ_1 with the slip s of a driven wheel.

    References
    ----------
    Z. Janosi, B. Hanamoto, The analytical determination of drawbar pull as a function of slip
    for tracked vehicles in deformable soils, 1st Int. Conf. Mechanics of Soil-Vehicle Systems,
    Turin 1961. J.Y. Wong, A.R. Reece, Prediction of rigid wheel performance based on the
    analysis of soil-wheel stresses, Journal of Terramechanics 4 (1967), 81-98 and 7-25.
    """

    wheel_width: float = quantity("m", "Width of the wheels on the soil", gt=0)
    cohesion: float = quantity("Pa", "Cohesion c", ge=0)
    friction_angle: float = quantity(
        "rad", "Angle of internal shearing resistance φ", ge=0, lt=math.pi / 2
    )
    shear_modulus: float = quantity("m", "Shear deformation modulus K", gt=0)
    exponent: float = quantity("1", "Exponent n of the sinkage", ge=0.5, le=3)
    front_share: float = quantity(
        "1",
        "c_1, where the pressure is largest without slip, over the angle of entry",
        default=0.4,
        gt=0,
        lt=1,
    )
    slip_share: float = quantity(
        "1", "c_2, how far that place moves with slip", default=0.2, ge=0, lt=1
    )

    @abstractmethod
    def pressure(self, sinkage: Scalar) -> Scalar:
        """Return the pressure under a plate of the wheels' width at a sinkage > 0 [m], in Pa."""

    def shear_strength(self, pressure: Scalar) -> Scalar:
        """Return the shear stress at which the soil yields under a pressure [Pa], in Pa."""
        return self.cohesion + pressure * ops.tan(self.friction_angle)


def power(base: Scalar, exponent: Scalar) -> Scalar:
    """Return a positive number to a power."""
    return ops.exp(exponent * ops.log(base))
