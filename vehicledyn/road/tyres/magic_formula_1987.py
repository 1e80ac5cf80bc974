"""Magic Formula of Bakker, Nyborg and Pacejka (1987) with combined slip by similarity."""

from __future__ import annotations

import math

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.tyres.magic_formula import curves
from vehicledyn.road.tyres.magic_formula_sets import (
    AligningCoefficients,
    LateralCoefficients,
    LongitudinalCoefficients,
)
from vehicledyn.road.tyres.similarity import similar_forces
from vehicledyn.road.tyres.tyre import Tyre, TyreForces, TyreInput

_PER_RADIAN = 180.0 / math.pi


@register("tyre", "magic_formula_1987")
class MagicFormula1987(Tyre):
    """Magic Formula of 1987; see :mod:`vehicledyn.road.tyres.magic_formula` for the pure curves.

    Combined slip by similarity: with the slips at the peaks of the pure curves, κ_m and α_m,
    and α_s = α + S_h,

    a = κ/κ_m,    b = tan α_s / tan α_m,    ρ = √(a² + b²),

    F_x = a/ρ X(κ_m ρ),    F_y = b/ρ Y(atan(ρ tan α_m)) + S_v,

    and M_z like F_y with its own shifts, computed with a, b and ρ times u_m = B κ_m, the place of
    the peak of X. At pure slip these are the pure curves. The vector
    (κ, tan α) is the theoretical slip times 1 + κ: of the same direction, and finite for a
    locked wheel. Side force from camber alone (S_v) does not fade with longitudinal slip.
    Camber beyond some 20° and loads beyond 20 kN are outside the fits; results stay finite.
    The paper's side force and moment are turned to ISO 8855 by a change of sign.

    References
    ----------
    Bakker, Nyborg, Pacejka (1987), SAE 870421; combined slip in the manner of Bakker,
    Pacejka, Lidner (1989), SAE 890087, which was not at hand.
    """

    lateral: LateralCoefficients = LateralCoefficients()
    aligning: AligningCoefficients = AligningCoefficients()
    longitudinal: LongitudinalCoefficients = LongitudinalCoefficients()
    friction: float = quantity(
        "1", "Friction of the road over that of the tests", default=1.0, gt=0
    )

    def forces(self, contact: TyreInput) -> TyreForces:
        """Return the forces at combined slip, in ISO 8855 signs."""
        load, camber = 0.001 * contact.normal_force, _PER_RADIAN * contact.camber
        slip, angle = 100.0 * contact.longitudinal_slip, _PER_RADIAN * contact.slip_angle
        across, moment, along = (
            curve.on_friction(self.friction)
            for curve in curves(load, camber, self.lateral, self.aligning, self.longitudinal)
        )
        return similar_forces((across, moment, along), slip, angle)
