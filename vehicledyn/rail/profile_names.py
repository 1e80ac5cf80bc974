"""Profiles by name: standard ones from their numbers, cones and circular arcs."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.base.slopes import slope_of
from vehicledyn.base.units import to_si
from vehicledyn.base.yaml import read_yaml
from vehicledyn.rail.profile import Kind, Profile
from vehicledyn.rail.profile_pieces import Arc, Piece, Polynomial

FOLDER = Path(__file__).parent / "profiles"
STANDARD = {"S1002": "s1002", "60E1": "60e1", "UIC60": "60e1", "60E1_manchester": "60e1_manchester"}
FORMULAS = ("cone:SLOPE", "arc:RADIUS")
_HALF_CONE, _HALF_ARC = 0.06, 0.036


def is_name(text: str) -> bool:
    """Return whether a text names a profile, rather than a file."""
    return _standard(text) is not None or text.partition(":")[0] in ("cone", "arc")


def named_profile(text: str, kind: Kind) -> Profile:
    """Return the profile of a name: S1002, 60E1, 60E1_manchester, cone:1/40 or arc:300 mm.

    Raises
    ------
    InputError
        If there is no such profile, or it is one of a rail where a wheel's is asked for.
    """
    formula, colon, value = text.partition(":")
    if colon and formula == "cone":
        return cone(_slope(text, value), kind)
    if colon and formula == "arc":
        return circle(_radius(text, value), kind)
    stem = _standard(text)
    if stem is None:
        guess = nearest_name(text, STANDARD)
        hint = f"; did you mean '{guess}'?" if guess else "."
        known = ", ".join((*STANDARD, *FORMULAS))
        raise InputError(f"'{text}' is neither a file nor a profile{hint} Known profiles: {known}")
    profile = standard_profile(stem, text)
    if profile.kind != kind:
        raise InputError(f"'{text}' is the profile of a {profile.kind}, a {kind}'s is needed here")
    return profile


def standard_profile(stem: str, name: str) -> Profile:
    """Return a profile of the folder ``profiles`` beside this module."""
    data = read_yaml(FOLDER / f"{stem}.yaml").data
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


def tangential_arcs(data: dict[str, Any], unit: float) -> tuple[Piece, ...]:
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


def _mirrored(piece: Arc | Polynomial) -> Piece:
    if isinstance(piece, Arc):
        centre = (-piece.centre[0], piece.centre[1])
        return Arc(-piece.end, -piece.begin, centre, piece.radius, piece.side)
    turned = tuple(c * (-1) ** k for k, c in enumerate(piece.coefficients))
    return Polynomial(-piece.end, -piece.begin, turned, piece.unit)


def _zones(zones: list[dict[str, Any]], unit: float) -> tuple[Piece, ...]:
    return tuple(_zone(zone, unit) for zone in zones)


def _zone(zone: dict[str, Any], unit: float) -> Piece:
    begin, end = zone["begin"] * unit, zone["end"] * unit
    if "coefficients" in zone:
        return Polynomial(begin, end, tuple(float(c) for c in zone["coefficients"]), unit)
    centre = (zone["centre"][0] * unit, zone["centre"][1] * unit)
    return Arc(begin, end, centre, zone["radius"] * unit, zone["side"])


def _standard(text: str) -> str | None:
    wanted = text.lower()
    return next((stem for name, stem in STANDARD.items() if name.lower() == wanted), None)


def _slope(text: str, value: str) -> float:
    slope = slope_of(value)
    if slope is None or not 0.0 <= slope < 1.0:
        raise InputError(f"'{text}': write a slope from 0 to 1, such as cone:1/40")
    return slope


def _radius(text: str, value: str) -> float:
    try:
        radius = to_si(f"{value} mm" if slope_of(value) is not None else value, "m")
    except InputError as error:
        raise InputError(f"'{text}': {error}") from None
    if not 1e-3 <= abs(radius) <= 1e3:
        raise InputError(f"'{text}': write a radius from 1 mm to 1000 m, such as 'arc:300 mm'")
    return radius
