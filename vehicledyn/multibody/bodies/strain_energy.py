"""Strain energy of a beam beyond that of bending, twist and stretch each by itself."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

from vehicledyn.multibody.bodies.beam_properties import Properties
from vehicledyn.multibody.bodies.beam_shapes import quadrature
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

Along: TypeAlias = Callable[[str, float, int], Scalar]
"""What a direction is displaced by at a place over the length, or a derivative by that place."""


def coupling_energy(along: Along, properties: Properties, points: int, length: Scalar) -> Scalar:
    """Return what bending in both planes and twist share [J].

    A section that is twisted bends about its own axes, v'' + ϑ w'' and w'' - ϑ v'', and bending
    in both planes twists it by ½ (v'' w' - w'' v').
    """
    total = ops.scalar(0.0)
    for place, weight in zip(*quadrature(points), strict=True):
        x = float(place)
        bent = {d: along(d, x, 2) / length**2 for d in ("y", "z")}
        slope = {d: along(d, x, 1) / length for d in ("y", "z")}
        twist, rate = along("twist", x, 0), along("twist", x, 1) / length
        wound = 0.5 * (bent["y"] * slope["z"] - bent["z"] * slope["y"])
        y, z = bent["y"] + twist * bent["z"], bent["z"] - twist * bent["y"]
        s = properties.at(x)
        gained = s.y * (y * y - bent["y"] * bent["y"]) + s.z * (z * z - bent["z"] * bent["z"])
        gained = gained + s.twist * wound * (2.0 * rate + wound)
        total = total + 0.5 * float(weight) * gained
    return total * length


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
