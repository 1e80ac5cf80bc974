"""Combined slip by similarity: pure curves of the Magic Formula, taken at one combined slip."""

from __future__ import annotations

import math

from vehicledyn.road.tyres.magic_formula import Curve, peak_places
from vehicledyn.road.tyres.tyre import TyreForces
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


def similar_forces(curves: tuple[Curve, Curve, Curve], slip: Scalar, angle: Scalar) -> TyreForces:
    """Return the forces of combined slip, in ISO 8855 signs.

    Parameters
    ----------
    curves
        Side force and moment over slip angle, in the paper's signs, and force over slip.
    slip, angle
        Longitudinal slip [%] and slip angle [deg].
    """
    across, moment, along = curves
    peak, across_peak = peak_places(along, across)
    peak_slip = across_peak / across.stiffness_factor
    peak_angle = _radians(ops.minimum(peak_slip, LARGEST_PEAK_ANGLE))
    angles = [_radians(angle + curve.horizontal_shift) for curve in (across, moment)]
    sine, far = ops.sin(peak_angle), peak * ops.cos(peak_angle)
    inverse = ops.reciprocals(sine, far, *map(ops.cos, angles))
    steepness = sine * inverse[1]  # tan α_m / u_m
    u = (slip + along.horizontal_shift) * along.stiffness_factor
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
    driving = u * shares[0] * along.at(sizes[0]) + along.vertical_shift
    return TyreForces(driving, force, turning)


def _radians(angle: Scalar) -> Scalar:
    return _DEGREE * ops.minimum(ops.maximum(angle, -LARGEST_ANGLE), LARGEST_ANGLE)
