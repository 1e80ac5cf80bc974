"""Profiles of a name: standard ones from their numbers, cones and circular arcs."""

from __future__ import annotations

import math
from typing import Any

from vehicledyn.base.units import to_si
from vehicledyn.rail.profiles.profile import Profile
from vehicledyn.rail.profiles.profile_names import Kind, arc_radius, cone_slope, standard_data
from vehicledyn.rail.profiles.profile_pieces import Arc, Polynomial, ProfilePiece

_HALF_CONE, _HALF_ARC = 0.06, 0.036


def named_profile(text: str, kind: Kind) -> Profile:
    """Return the profile of a name: S1002, 60E1, 60E1_manchester, cone:1/40 or arc:300 mm.

    Raises
    ------
    InputError
        If there is no such profile, or it is one of a rail where a wheel's is asked for.
    """
    slope, radius = cone_slope(text), arc_radius(text)
    if slope is not None:
        return cone(slope, kind)
    if radius is not None:
        return circle(radius, kind)
    return standard_profile(text, standard_data(text, kind))


def standard_profile(name: str, data: dict[str, Any]) -> Profile:
    """Return a profile from the numbers that a file of the folder ``profiles`` holds."""
    unit = to_si(f"1 {data['unit']}", "m")
    pieces = _zones(data["zones"], unit) if "zones" in data else tangential_arcs(data, unit)
    return Profile(name, data["kind"], pieces, data["source"])


def cone(slope: float, kind: Kind) -> Profile:
    """Return a conical tread, whose radius falls outwards by ``slope``, or an inclined plane."""
    line = Polynomial(-_HALF_CONE, _HALF_CONE, (0.0, -slope))
    return Profile(f"cone of slope {slope:g}", kind, (line,), "formula")


def circle(radius: float, kind: Kind) -> Profile:
    """Return a profile that is one arc about y = 0 [m].

    A rail is round upwards. A wheel of negative radius is hollow, as worn wheels are; of positive
    radius round like a ball.
    """
    half = min(_HALF_ARC, 0.9 * abs(radius))
    side = 1 if radius > 0.0 else -1
    arc = Arc(-half, half, (0.0, -radius), abs(radius), side)
    return Profile(f"arc of radius {radius:g} m", kind, (arc,), "formula")


def tangential_arcs(data: dict[str, Any], unit: float) -> tuple[ProfilePiece, ...]:
    """Return a symmetric head of arcs that meet without corner, then a straight flank.

    ``radii`` run from the crown outwards, ``widths`` are the full widths at which one arc ends,
    ``flank`` is the run a unit of fall, ``lowest`` the height at which the flank ends.
    """
    radii = [unit * radius for radius in data["radii"]]
    edges = [0.5 * unit * width for width in data["widths"]]
    run, lowest = float(data["flank"]), unit * data["lowest"]
    centre = (0.0, -radii[0])
    arcs: list[Arc] = []
    for k, radius in enumerate(radii):
        if k > 0:
            share = (edges[k - 1] - centre[0]) / radii[k - 1]
            rest = math.sqrt(1.0 - share**2)
            shorter = radii[k - 1] - radius
            centre = (centre[0] + shorter * share, centre[1] + shorter * rest)
        end = edges[k] if k < len(edges) else centre[0] + radius / math.hypot(1.0, run)
        begin = edges[k - 1] if k > 0 else -end
        arcs.append(Arc(begin, end, centre, radius))
    edge = arcs[-1].end
    height = centre[1] + radii[-1] * run / math.hypot(1.0, run)
    foot = edge + run * (height - lowest)
    flank = Polynomial(edge, foot, (height + edge / run, -1.0 / run))
    right: list[Arc | Polynomial] = [*arcs[1:], flank]
    left = [_mirrored(piece) for piece in reversed(right)]
    return (*left, arcs[0], *right)


def _mirrored(piece: Arc | Polynomial) -> ProfilePiece:
    if isinstance(piece, Arc):
        centre = (-piece.centre[0], piece.centre[1])
        return Arc(-piece.end, -piece.begin, centre, piece.radius, piece.side)
    turned = tuple(c * (-1) ** k for k, c in enumerate(piece.coefficients))
    return Polynomial(-piece.end, -piece.begin, turned, piece.unit)


def _zones(zones: list[dict[str, Any]], unit: float) -> tuple[ProfilePiece, ...]:
    return tuple(_zone(zone, unit) for zone in zones)


def _zone(zone: dict[str, Any], unit: float) -> ProfilePiece:
    begin, end = zone["begin"] * unit, zone["end"] * unit
    if "coefficients" in zone:
        return Polynomial(begin, end, tuple(float(c) for c in zone["coefficients"]), unit)
    centre = (zone["centre"][0] * unit, zone["centre"][1] * unit)
    return Arc(begin, end, centre, zone["radius"] * unit, zone["side"])
