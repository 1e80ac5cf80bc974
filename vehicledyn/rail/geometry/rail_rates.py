"""How a rail in its place follows gauge, the depth at which that is measured, and inclination.

The rail turns about the axis of its profile with the inclination, while its crown keeps its height
and its gauge face its place.
"""

from __future__ import annotations

import numpy as np

from vehicledyn.rail.geometry.contact_geometry import FACE_STEP, RAIL_STEP, Rail, gauge_face
from vehicledyn.rail.profiles.profile_pieces import Floats, QuinticTable

_REFINEMENTS = 12


def rail_rates(rail: Rail, gauge_depth: float, y: float) -> dict[str, tuple[float, float]]:
    """Return how height and slope of a placed rail at a place y follow its measures.

    Parameters
    ----------
    rail
        A rail as from :func:`place_rail`.
    gauge_depth
        Depth below the top down to which the gauge is measured [m].
    y
        Place from the middle of the track [m].

    Returns
    -------
    dict
        By "gauge" [m], "gauge_depth" [m] and "inclination" [rad].
    """
    surface, (across, sunk) = rail.surface, rail.origin
    count = int(np.ceil((surface.end - surface.begin) / RAIL_STEP)) + 1
    places = np.linspace(surface.begin, surface.end, count)
    crown = _crown(surface, places) - across
    by_angle, by_depth = _face_rates(rail, crown, gauge_depth)
    r, slope, bend = (float(row[0]) for row in surface.values(np.array([y])))
    over, aside = -(r - sunk) - by_angle, (y - across) - crown
    return {
        "gauge": (-0.5 * slope, -0.5 * bend),
        "gauge_depth": (slope * by_depth, bend * by_depth),
        "inclination": (aside - slope * over, 1.0 + slope * slope - bend * over),
    }


def _crown(surface: QuinticTable, places: Floats) -> float:
    """Return where a surface is highest."""
    best = int(np.argmax(surface.height(places)))
    y = float(places[best])
    for _ in range(_REFINEMENTS):
        _, slope, bend = (float(row[0]) for row in surface.values(np.array([y])))
        if not bend < 0.0:
            break
        y -= slope / bend
    return y


def _face_rates(rail: Rail, crown: float, gauge_depth: float) -> tuple[float, float]:
    """Return how the gauge face of a leaning rail moves with inclination and depth [m/rad, 1].

    ``crown`` is where it is highest, from the axis of the profile [m].
    """
    across, top = rail.origin[0], -rail.origin[1]
    surface, level = rail.surface, top - gauge_depth
    count = int(np.ceil((surface.end - surface.begin) / RAIL_STEP)) + 1
    places = np.linspace(surface.begin, surface.end, count)
    face = gauge_face(surface, places, -gauge_depth)
    if face > surface.begin:
        slope = float(surface.values(np.array([face]))[1][0])
        rise = (face - across) + slope * level
        return (crown - rise) / slope, -1.0 / slope
    profile, c, s = rail.profile, np.cos(rail.inclination), np.sin(rail.inclination)
    y = np.linspace(profile.begin, profile.end, int((profile.end - profile.begin) / FACE_STEP) + 2)
    z = profile.height(y)
    up, out = s * y + c * z, c * y - s * z
    above = np.flatnonzero(up >= level)
    if above[np.argmin(out[above])] != above[0] or above[0] == 0:
        return -float(up[above[np.argmin(out[above])]]), 0.0
    at = float(y[above[0]])
    for _ in range(_REFINEMENTS):
        height, steep = float(profile.height(at)), float(profile.slope(at))
        at -= (s * at + c * height - level) / (s + c * steep)
    height, steep = float(profile.height(at)), float(profile.slope(at))
    lean = (c - s * steep) / (s + c * steep)
    return -level + lean * (crown - (c * at - s * height)), -lean
