"""Strain energy of a beam beyond that of bending, twist and stretch each by itself."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vehicledyn.multibody.bodies.beam_properties import Properties
from vehicledyn.multibody.bodies.beam_shapes import quadrature
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

Array = NDArray[np.float64]
Along: TypeAlias = Callable[[str, float, int], Scalar]
"""What a direction is displaced by at a place over the length, or a derivative by that place."""


def coupling_energy(
    along: Along, properties: Properties, points: int, length: Scalar, *, is_steep: bool
) -> Scalar:
    """Return what bending in both planes and twist share, and what steep slopes add [J].

    A section that is twisted bends about its own axes, and bending in both planes twists it by
    (v'' w' - w'' v') / (1 + √(1 - e)) with the squared slope e.
    """
    total = ops.scalar(0.0)
    for place, weight in zip(*quadrature(points), strict=True):
        x = float(place)
        plain, slope = _bent(along, x, length)
        twist, rate = along("twist", x, 0), along("twist", x, 1) / length
        e = slope["y"] * slope["y"] + slope["z"] * slope["z"] if is_steep else 0.0
        wound = (0.5 + 0.125 * e) * (plain["y"] * slope["z"] - plain["z"] * slope["y"])
        bent = _curvatures(plain, slope) if is_steep else plain
        sine, cosine = _turn(twist)
        y = cosine * bent["y"] + sine * bent["z"]
        z = cosine * bent["z"] - sine * bent["y"]
        s = properties.at(x)
        gained = s.y * (y * y - plain["y"] * plain["y"]) + s.z * (z * z - plain["z"] * plain["z"])
        gained = gained + s.twist * wound * (2.0 * rate + wound)
        total = total + 0.5 * float(weight) * gained
    return total * length


def steep_energy(
    along: Along,
    planes: Sequence[str],
    properties: Properties,
    places: tuple[Array, Array],
    length: Scalar,
) -> Scalar:
    """Return what bending has more where slopes are not small [J].

    Parameters
    ----------
    along, properties, length
        Of the beam.
    planes
        In which it bends.
    places
        Places and weights of a quadrature.
    """
    total = ops.scalar(0.0)
    for place, weight in zip(*places, strict=True):
        x = float(place)
        plain, slope = _bent(along, x, length, planes)
        for d, bent in _curvatures(plain, slope).items():
            modulus = getattr(properties.at(x), d)
            gained = modulus * (bent - plain[d]) * (bent + plain[d])
            total = total + 0.5 * float(weight) * gained
    return total * length


def _bent(
    along: Along, place: float, length: Scalar, planes: Sequence[str] = ("y", "z")
) -> tuple[dict[str, Scalar], dict[str, Scalar]]:
    """Return second derivatives and slopes of the deflection of each plane."""
    bent = {d: along(d, place, 2) / length**2 for d in planes}
    return bent, {d: along(d, place, 1) / length for d in planes}


def _curvatures(bent: Mapping[str, Scalar], slopes: Mapping[str, Scalar]) -> dict[str, Scalar]:
    """Return the curvatures of an axis whose sections are turned by the shortest rotation.

    That is v'' + v' (v' v'' + w' w'') / (c + c²) with c = √(1 - e), to the fifth power of slopes.
    """
    e, along = ops.scalar(0.0), ops.scalar(0.0)
    for d, slope in slopes.items():
        e, along = e + slope * slope, along + slope * bent[d]
    more = (0.5 + 0.375 * e) * along
    return {d: bent[d] + more * slope for d, slope in slopes.items()}


def _turn(angle: Scalar) -> tuple[Scalar, Scalar]:
    """Return sine and cosine of an angle to its fourth power, those of a rotation in any case."""
    half = 0.5 * angle
    tangent = half * (1.0 + half * half / 3.0)
    over = 1.0 / (1.0 + tangent * tangent)
    return 2.0 * tangent * over, (1.0 - tangent * tangent) * over


def axial_energy(along: Along, properties: Properties, points: int, length: Scalar) -> Scalar:
    """Return the energy of the axial force in bending [J]."""
    total = ops.scalar(0.0)
    for place, weight in zip(*quadrature(points), strict=True):
        x, share = float(place), ops.scalar(float(weight))
        if not properties.is_uniform:
            share = share * properties.at(x).stretch / properties.start.stretch
        slopes = [along(d, x, 1) for d in ("y", "z")]
        total = total + share * along("stretch", x, 1) * sum(slope * slope for slope in slopes)
    return 0.5 * properties.start.stretch / length**2 * total
