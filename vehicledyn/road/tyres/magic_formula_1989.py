"""Magic Formula of 1989 in the layout of ADAMS: coefficients a0 to a13, b0 to b10, c0 to c17."""

from __future__ import annotations

import math

from pydantic import ValidationInfo, field_validator

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.tyres.magic_formula import (
    CAMBER_FACTOR_FLOOR,
    LOAD_FLOOR_KN,
    LOAD_LIMIT_KN,
    Curve,
)
from vehicledyn.road.tyres.similarity import similar_forces
from vehicledyn.road.tyres.smooth import floored
from vehicledyn.road.tyres.tyre import Tyre, TyreForces, TyreInput
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

CAMBER_LIMIT = 30.0
"""Camber beyond which forces no longer change; the fits are far outside their data [deg]."""

_PER_RADIAN = 180.0 / math.pi
_UNITS = "loads in kN, angles in degrees, slip in %, forces in N and moments in N m"


@register("tyre", "magic_formula_1989")
class MagicFormula1989(Tyre):
    """Magic Formula of 1989; combined slip by similarity, as for the formula of 1987.

    With the load F in kN, γ in degrees, x the slip in per cent and the slip angle in degrees,

    F_y: C = a0, D = (a1 F + a2) F, BCD = a3 sin(2 atan(F/a4)) (1 - a5 |γ|), E = a6 F + a7,
    S_h = a8 γ + a9 F + a10, S_v = a11 F γ + a12 F + a13;

    F_x: C = b0, D = (b1 F + b2) F, BCD = (b3 F² + b4 F) exp(-b5 F), E = b6 F² + b7 F + b8,
    S_h = b9 F + b10;

    M_z: C = c0, D = (c1 F + c2) F, BCD = (c3 F² + c4 F) (1 - c6 |γ|) exp(-c5 F),
    E = (c7 F² + c8 F + c9) (1 - c10 |γ|), S_h = c11 γ + c12 F + c13,
    S_v = (c14 F² + c15 F) γ + c16 F + c17.

    Below 1 N of load forces are in proportion to it, so that constants in S_v vanish, too.

    References
    ----------
    Bakker, Pacejka, Lidner (1989), SAE 890087, by way of the public programs Magic-Formula-89
    and Chrono; the form of F_x is recalled.
    """

    lateral: tuple[float, ...] = quantity("1", f"a0 to a13: {_UNITS}")
    longitudinal: tuple[float, ...] = quantity("1", f"b0 to b10: {_UNITS}")
    aligning: tuple[float, ...] = quantity("1", f"c0 to c17: {_UNITS}")
    friction: float = quantity(
        "1", "Friction of the road over that of the tests", default=1.0, gt=0
    )

    @field_validator("lateral", "longitudinal", "aligning")
    @classmethod
    def _count(cls, value: tuple[float, ...], info: ValidationInfo) -> tuple[float, ...]:
        wanted = _COUNTS[str(info.field_name)]
        if len(value) != wanted:
            raise ValueError(f"expected {wanted} coefficients, found {len(value)}")
        if not 1.0 < value[0] <= _LARGEST_SHAPE:
            raise ValueError(f"the shape factor C, first of them, must be above 1: {value[0]:g}")
        for places in _NEEDED[str(info.field_name)]:
            if not any(value[k] for k in places):
                names = " or ".join(f"number {k}" for k in places)
                raise ValueError(f"{names}, counted from 0, must not be zero")
        return value

    def forces(self, contact: TyreInput) -> TyreForces:
        """Return the forces at combined slip, in ISO 8855 signs."""
        load_in_kn, leaning = 0.001 * contact.normal_force, _PER_RADIAN * contact.camber
        camber = ops.minimum(ops.maximum(leaning, -CAMBER_LIMIT), CAMBER_LIMIT)
        load = ops.minimum(floored(load_in_kn, LOAD_FLOOR_KN), LOAD_LIMIT_KN)
        curves = (
            _lateral(self.lateral, load, camber),
            _aligning(self.aligning, load, camber),
            _longitudinal(self.longitudinal, load),
        )
        across, moment, along = (curve.on_friction(self.friction) for curve in curves)
        slip, angle = 100.0 * contact.longitudinal_slip, _PER_RADIAN * contact.slip_angle
        found = similar_forces((across, moment, along), slip, angle)
        share = load_in_kn / load
        return TyreForces(
            share * found.longitudinal_force,
            share * found.lateral_force,
            share * found.aligning_moment,
        )


_LARGEST_SHAPE = 4.0
_COUNTS = {"lateral": 14, "longitudinal": 11, "aligning": 18}
_NEEDED = {"lateral": ((1, 2), (3,), (4,)), "longitudinal": ((1, 2), (3, 4)), "aligning": ()}
"""Places of coefficients of which one at least is not zero; a tyre may have no moment."""


def _lateral(a: tuple[Scalar, ...], F: Scalar, camber: Scalar) -> Curve:
    D = (a[1] * F + a[2]) * F
    K = a[3] * ops.sin(2.0 * ops.atan(F / a[4])) * _lean(a[5], camber)
    shift = a[8] * camber + a[9] * F + a[10]
    rise = a[11] * F * camber + a[12] * F + a[13]
    return Curve(D, a[0], K / (a[0] * D), ops.minimum(a[6] * F + a[7], 1.0), shift, rise)


def _longitudinal(b: tuple[Scalar, ...], F: Scalar) -> Curve:
    D = (b[1] * F + b[2]) * F
    K = (b[3] * F + b[4]) * F * ops.exp(-b[5] * F)
    E = ops.minimum((b[6] * F + b[7]) * F + b[8], 1.0)
    return Curve(D, b[0], K / (b[0] * D), E, b[9] * F + b[10])


def _aligning(c: tuple[Scalar, ...], F: Scalar, camber: Scalar) -> Curve:
    D = (c[1] * F + c[2]) * F
    K = (c[3] * F + c[4]) * F * _lean(c[6], camber) * ops.exp(-c[5] * F)
    E = ops.minimum(((c[7] * F + c[8]) * F + c[9]) * (1.0 - c[10] * ops.absolute(camber)), 1.0)
    shift = c[11] * camber + c[12] * F + c[13]
    rise = (c[14] * F + c[15]) * F * camber + c[16] * F + c[17]
    B = 0.0 if ops.is_structurally_zero(D) else K / (c[0] * D)
    return Curve(D, c[0], B, E, shift, rise)


def _lean(factor: Scalar, camber: Scalar) -> Scalar:
    return floored(1.0 - factor * ops.absolute(camber), CAMBER_FACTOR_FLOOR)
