"""Magic Formula of 1987 in the paper's own units and signs: curves at pure and combined slip.

    Y = D sin(C atan(B φ)) + S_v,    φ = (1 - E)(x + S_h) + E/B atan(B (x + S_h))

Loads are in kN, angles in degrees, the longitudinal slip in per cent, forces in N, moments in
N m. A positive slip angle gives a positive side force and mostly a negative aligning moment.

References
----------
Bakker, Nyborg, Pacejka (1987), SAE 870421, by way of public programs that agree; the camber
corrections of B and E are those of the programs that have them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from vehicledyn.road.tyres.magic_formula_sets import (
    AligningCoefficients,
    LateralCoefficients,
    LongitudinalCoefficients,
)
from vehicledyn.road.tyres.smooth import floored
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

SHAPE_LATERAL, SHAPE_ALIGNING, SHAPE_LONGITUDINAL = 1.30, 2.40, 1.65
"""C of the three curves, constants of the paper [1]."""

LOAD_FLOOR_KN = 1e-3
"""Load below which the shape of the curves no longer changes [kN]."""

LOAD_LIMIT_KN = 20.0
"""Load above which forces grow in proportion; the fits are far outside their data [kN]."""

CAMBER_FACTOR_FLOOR = 0.1
"""Least value of the corrections 1 - a12 |γ| and 1 - a13 |γ| [1]."""


@dataclass(frozen=True)
class Curve:
    """One curve of the formula at a given load and camber.

    Attributes
    ----------
    peak, shape, stiffness_factor, curvature
        D [N or N m], C [1], B [1/deg or 1/%] and E [1].
    horizontal_shift, vertical_shift
        S_h [deg] and S_v [N or N m].
    """

    peak: Scalar
    shape: Scalar
    stiffness_factor: Scalar
    curvature: Scalar
    horizontal_shift: Scalar = 0.0
    vertical_shift: Scalar = 0.0

    def symmetric(self, slip: Scalar) -> Scalar:
        """Return D sin(C atan(B φ)) of a slip that is already shifted."""
        return self.at(self.stiffness_factor * slip)

    def at(self, u: Scalar) -> Scalar:
        """Return D sin(C atan(B φ)) at u, the shifted slip times B."""
        bent = (1.0 - self.curvature) * u + self.curvature * ops.atan(u)
        return self.peak * ops.sin(self.shape * ops.atan(bent))

    def value(self, slip: Scalar) -> Scalar:
        """Return Y of a slip [deg or %]."""
        return self.symmetric(slip + self.horizontal_shift) + self.vertical_shift

    def peak_slip(self) -> Scalar:
        """Return the shifted slip at the peak, where C atan(B φ) = π/2 [deg or %]."""
        return self.peak_place() / self.stiffness_factor

    def peak_place(self) -> Scalar:
        """Return u at the peak, the shifted slip times B [1]; see :func:`peak_places`."""
        return peak_places(self)[0]

    def on_friction(self, friction: Scalar) -> Curve:
        """Return the curve on a road of another friction, of the same slope at no slip.

        Similarity: Y(x; μ) = μ Y(x/μ); shifts by camber are kept.
        """
        return replace(
            self,
            peak=friction * self.peak,
            stiffness_factor=self.stiffness_factor / friction,
        )


def peak_places(*curves: Curve) -> list[Scalar]:
    """Return u at the peak of each curve, the shifted slip times B [1].

    Two Newton steps from the value for E = 0: within 1 % for loads to 20 kN, within
    0.1 % from 2 to 8 kN. It only scales combined slip, pure slip does not depend on it.
    """
    targets = [_tangent(0.5 * math.pi / curve.shape) for curve in curves]
    places: list[Scalar] = list(targets)
    for _ in range(2):
        bends = [(1.0 - c.curvature) * (1.0 + u * u) for c, u in zip(curves, places, strict=True)]
        slopes = [bend + c.curvature for c, bend in zip(curves, bends, strict=True)]
        inverse = ops.reciprocals(*slopes)  # of numbers that are at least one
        for k, (curve, target) in enumerate(zip(curves, targets, strict=True)):
            E, u = curve.curvature, places[k]
            error = (1.0 - E) * u + E * ops.atan(u) - target
            places[k] = u - error * (1.0 + u * u) * inverse[k]
    return places


def _tangent(angle: Scalar) -> Scalar:
    """Return the tangent, of a number without its rounding by CasADi."""
    return math.tan(angle) if isinstance(angle, float) else ops.tan(angle)


def curves(
    load_kN: Scalar,
    camber_deg: Scalar,
    lateral: LateralCoefficients,
    aligning: AligningCoefficients,
    longitudinal: LongitudinalCoefficients,
) -> tuple[Curve, Curve, Curve]:
    """Return the curves of side force and moment over slip angle and of force over slip."""
    across, moment, along = _drawn(
        _lateral_fit(load_kN, camber_deg, lateral),
        _aligning_fit(load_kN, camber_deg, aligning),
        _longitudinal_fit(load_kN, longitudinal),
    )
    return across, moment, along


def lateral_curve(load_kN: Scalar, camber_deg: Scalar, c: LateralCoefficients) -> Curve:
    """Return the curve of the side force over the slip angle."""
    return _drawn(_lateral_fit(load_kN, camber_deg, c))[0]


def aligning_curve(load_kN: Scalar, camber_deg: Scalar, c: AligningCoefficients) -> Curve:
    """Return the curve of the aligning moment over the slip angle."""
    return _drawn(_aligning_fit(load_kN, camber_deg, c))[0]


def longitudinal_curve(load_kN: Scalar, c: LongitudinalCoefficients) -> Curve:
    """Return the curve of the longitudinal force over the longitudinal slip."""
    return _drawn(_longitudinal_fit(load_kN, c))[0]


def lateral_force(
    load_kN: Scalar, slip_angle_deg: Scalar, camber_deg: Scalar, coefficients: LateralCoefficients
) -> Scalar:
    """Return the side force at pure side slip [N], in the paper's sign."""
    return lateral_curve(load_kN, camber_deg, coefficients).value(slip_angle_deg)


def aligning_moment(
    load_kN: Scalar, slip_angle_deg: Scalar, camber_deg: Scalar, coefficients: AligningCoefficients
) -> Scalar:
    """Return the aligning moment at pure side slip [N m], in the paper's sign."""
    return aligning_curve(load_kN, camber_deg, coefficients).value(slip_angle_deg)


def longitudinal_force(
    load_kN: Scalar, slip_percent: Scalar, coefficients: LongitudinalCoefficients
) -> Scalar:
    """Return the longitudinal force at pure longitudinal slip [N]."""
    return longitudinal_curve(load_kN, coefficients).value(slip_percent)


@dataclass(frozen=True)
class _Fit:
    """What a curve is made from: B = ``stiffness`` / ``divisor``, E = ``bend`` / ``lean``."""

    peak: Scalar
    shape: float
    stiffness: Scalar
    divisor: Scalar
    bend: Scalar
    lean: Scalar = 1.0
    horizontal_shift: Scalar = 0.0
    vertical_shift: Scalar = 0.0


def _drawn(*fits: _Fit) -> list[Curve]:
    """Return curves by one division for all of them."""
    inverse = ops.reciprocals(*(item for fit in fits for item in (fit.divisor, fit.lean)))
    return [
        Curve(
            fit.peak,
            fit.shape,
            fit.stiffness * inverse[2 * k],
            ops.minimum(fit.bend * inverse[2 * k + 1], 1.0),
            fit.horizontal_shift,
            fit.vertical_shift,
        )
        for k, fit in enumerate(fits)
    ]


def _lateral_fit(load_kN: Scalar, camber_deg: Scalar, c: LateralCoefficients) -> _Fit:
    F = _fitted_load(load_kN)
    D = c.a1 * F + c.a2
    stiffness = c.a3 * ops.sin(c.a4 * ops.atan(c.a5 * F))
    fit = _Fit(load_kN * D, SHAPE_LATERAL, stiffness, SHAPE_LATERAL * F * D, _bend(F, c))
    return _cambered(fit, load_kN, F, camber_deg, c)


def _aligning_fit(load_kN: Scalar, camber_deg: Scalar, c: AligningCoefficients) -> _Fit:
    F = _fitted_load(load_kN)
    D = c.a1 * F + c.a2
    stiffness = (c.a3 * F + c.a4) * ops.exp(-c.a5 * F)
    fit = _Fit(load_kN * D, SHAPE_ALIGNING, stiffness, SHAPE_ALIGNING * D, _bend(F, c))
    return _cambered(fit, load_kN, F, camber_deg, c)


def _longitudinal_fit(load_kN: Scalar, c: LongitudinalCoefficients) -> _Fit:
    F = _fitted_load(load_kN)
    D = c.a1 * F + c.a2
    stiffness = (c.a3 * F + c.a4) * ops.exp(-c.a5 * F)
    return _Fit(load_kN * D, SHAPE_LONGITUDINAL, stiffness, SHAPE_LONGITUDINAL * D, _bend(F, c))


def _bend(
    F: Scalar, c: LateralCoefficients | AligningCoefficients | LongitudinalCoefficients
) -> Scalar:
    return c.a6 * F * F + c.a7 * F + c.a8


def _fitted_load(load_kN: Scalar) -> Scalar:
    return ops.minimum(floored(load_kN, LOAD_FLOOR_KN), LOAD_LIMIT_KN)


def _cambered(
    fit: _Fit,
    load_kN: Scalar,
    F: Scalar,
    camber_deg: Scalar,
    c: LateralCoefficients | AligningCoefficients,
) -> _Fit:
    """Return a fit corrected for camber."""
    lean = ops.absolute(camber_deg)
    return replace(
        fit,
        stiffness=fit.stiffness * floored(1.0 - c.a12 * lean, CAMBER_FACTOR_FLOOR),
        lean=floored(1.0 - c.a13 * lean, CAMBER_FACTOR_FLOOR),
        horizontal_shift=c.a9 * camber_deg,
        vertical_shift=load_kN * (c.a10 * F + c.a11) * camber_deg,
    )
