"""Magic Formula of Bakker, Nyborg and Pacejka (1987) with combined slip by similarity."""

from __future__ import annotations

import math

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.tyres.magic_formula import curves, peak_places
from vehicledyn.road.tyres.magic_formula_sets import (
    AligningCoefficients,
    LateralCoefficients,
    LongitudinalCoefficients,
)
from vehicledyn.road.tyres.tyre import Tyre, TyreForces, TyreInput
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

SLIP_FLOOR = 1e-6
"""Rounds the magnitude of the relative slip at zero slip [1]."""

LARGEST_ANGLE = 89.0
"""Shifted slip angles beyond this one are taken as this one [deg]."""

LARGEST_PEAK_ANGLE = 60.0
"""Bound of the slip angle of the peak, for coefficients that would put it beyond 90° [deg]."""

_DEGREE = math.pi / 180.0
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
        peak, across_peak = peak_places(along, across)
        peak_slip = across_peak / across.stiffness_factor
        peak_angle = _radians(ops.minimum(peak_slip, LARGEST_PEAK_ANGLE))
        angles = [_radians(angle + curve.horizontal_shift) for curve in (across, moment)]
        sine, far = ops.sin(peak_angle), peak * ops.cos(peak_angle)
        inverse = ops.reciprocals(sine, far, *map(ops.cos, angles))
        steepness = sine * inverse[1]  # tan α_m / u_m
        u = slip * along.stiffness_factor
        sides = [
            ops.sin(angle) * item * (far * inverse[0])
            for angle, item in zip(angles, inverse[2:], strict=True)
        ]
        sizes = [ops.smooth_norm(u, v, SLIP_FLOOR * peak) for v in sides]
        shares = ops.reciprocals(*sizes)
        force, turning = (
            -v * share * curve.symmetric(_PER_RADIAN * ops.atan(size * steepness))
            - curve.vertical_shift
            for curve, v, size, share in zip((across, moment), sides, sizes, shares, strict=True)
        )
        return TyreForces(u * shares[0] * along.at(sizes[0]), force, turning)


def _radians(angle: Scalar) -> Scalar:
    return _DEGREE * ops.minimum(ops.maximum(angle, -LARGEST_ANGLE), LARGEST_ANGLE)
