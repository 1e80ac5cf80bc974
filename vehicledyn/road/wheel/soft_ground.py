"""Forces of soft soil on a rolling rim: pressure and shear integrated over the arc of contact.

The rim of radius R enters the soil at the angle θ_1 = acos(1 - z/R) before the lowest point and
leaves it at the lowest point. From the place of largest pressure θ_m forwards the soil presses
as under a plate at the same depth; behind it as at the place in front that it is mapped to
(Wong and Reece 1967):

    σ(θ) = p(R (cos θ - cos θ_1))                              θ_m < θ < θ_1
    σ(θ) = p(R (cos(θ_1 - (θ_1 - θ_m) θ/θ_m) - cos θ_1))       0 < θ < θ_m

The shear displacements since entry are, for steady motion,

    j_x = R [d ((θ_1 - θ) - (sin θ_1 - sin θ)) + s (sin θ_1 - sin θ)]
    j_y = R (1 - s d) (θ_1 - θ) tan α

with s = κ/(1 + d κ), 1 - v/(Ω R) in forward motion, and the direction of travel d, which fades
through zero at standstill. The shear stress acts against the resultant displacement. The soil's
wall beside the wheel (bulldozing) is left out, and each wheel meets fresh soil.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vehicledyn.road.soils.soil import Soil
from vehicledyn.road.tyres.smooth import floored
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

POINTS = 6
"""Points of the Gauss-Legendre rule on either side of the largest pressure."""

SINKAGE_FLOOR = 1e-5
"""Sinkage that is never gone below inside the laws [m]."""

ROLLING_FLOOR = 0.02
"""Least Ω R/v; slower wheels count as locked [1]."""

TRAVEL_SPEED = 0.05
"""Speed at which the direction of travel is established [m/s]."""

_DISPLACEMENT_FLOOR = 1e-9


@dataclass(frozen=True)
class SoilForces:
    """Forces of the soil on the wheel.

    Attributes
    ----------
    load
        Along the ground normal [N].
    pull, side
        Along the wheel, positive when driving, and to its left [N].
    torque
        Against the spin, about the wheel's axis [N m].
    turning
        About the ground normal at the lowest point [N m].
    """

    load: Scalar
    pull: Scalar
    side: Scalar
    torque: Scalar
    turning: Scalar


def direction_of_travel(speed: Scalar) -> Scalar:
    """Return 1 forwards, -1 backwards, fading through zero at standstill."""
    return speed / ops.sqrt(speed * speed + TRAVEL_SPEED**2)


def soil_forces(
    soil: Soil,
    radius: Scalar,
    sinkage: Scalar,
    *,
    slip: Scalar,
    side_slip: Scalar = 0.0,
    direction: Scalar = 1.0,
) -> SoilForces:
    """Return the forces of soil on a wheel that rolls steadily in it.

    Parameters
    ----------
    soil
        Soil with the wheel's width.
    radius, sinkage
        Radius of the rim and depth of its lowest point; below SINKAGE_FLOOR as there [m].
    slip, side_slip
        κ = (Ω R - v_x)/|v_x| and tan α = v_y/|v_x| [1].
    direction
        Direction of travel, see :func:`direction_of_travel`.
    """
    depth = floored(sinkage, SINKAGE_FLOOR)
    rolled = floored(1.0 + direction * slip, ROLLING_FLOOR)
    driven = slip / rolled
    entry = 2.0 * ops.asin(ops.sqrt(ops.minimum(0.5 * depth / radius, 0.5)))
    place = soil.front_share + soil.slip_share * ops.maximum(direction * driven, 0.0)
    crest = entry * ops.minimum(place, 0.95)
    motion = driven, side_slip, direction, rolled
    total: list[Scalar] = [0.0] * 5
    for behind in (True, False):
        start, length = (0.0, crest) if behind else (crest, entry - crest)
        for node, weight in zip(*np.polynomial.legendre.leggauss(POINTS), strict=True):
            angle = start + 0.5 * length * (1.0 + float(node))
            seen = entry - (entry - crest) * angle / crest if behind else angle
            stress = _stress(soil, radius, entry, seen)
            shear = _shear(soil, radius, (entry, angle), stress, motion)
            area = 0.5 * length * float(weight) * radius * soil.wheel_width
            parts = _parts(radius, angle, stress, shear, direction)
            total = [known + area * part for known, part in zip(total, parts, strict=True)]
    return SoilForces(*total)


def _stress(soil: Soil, radius: Scalar, entry: Scalar, angle: Scalar) -> Scalar:
    depth = radius * (ops.cos(angle) - ops.cos(entry))
    return soil.pressure(floored(depth, 1e-3 * SINKAGE_FLOOR))


def _shear(
    soil: Soil,
    radius: Scalar,
    arc: tuple[Scalar, Scalar],
    stress: Scalar,
    motion: tuple[Scalar, Scalar, Scalar, Scalar],
) -> tuple[Scalar, Scalar]:
    """Return the shear stresses along the rim and across it."""
    (entry, angle), (driven, side_slip, direction, rolled) = arc, motion
    turned, moved = entry - angle, ops.sin(entry) - ops.sin(angle)
    along = radius * (direction * (turned - moved) + driven * moved)
    across = radius * turned * side_slip / rolled
    length = ops.smooth_norm(along, across, _DISPLACEMENT_FLOOR)
    share = (1.0 - ops.exp(-length / soil.shear_modulus)) / length
    strength = soil.shear_strength(stress) * share
    return strength * along, strength * across


def _parts(
    radius: Scalar, angle: Scalar, stress: Scalar, shear: tuple[Scalar, Scalar], direction: Scalar
) -> tuple[Scalar, ...]:
    """Return load, pull, side force, torque and turning moment of a piece of rim, over its area."""
    sine, cosine = direction * ops.sin(angle), ops.cos(angle)
    along, across = shear
    return (
        stress * cosine + along * sine,
        along * cosine - stress * sine,
        -across,
        along * radius,
        -across * radius * sine,
    )
