"""Report ground from a file that is steeper than a wheel which touches in one point can feel."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.units import shown
from vehicledyn.road.surfaces.surface import RoadSurface

if TYPE_CHECKING:
    from vehicledyn.files.scenario import LoadedScenario

STEEPEST = 1.0
"""Slope beyond which ground counts as an edge [1]; vehicles climb 0.6 to 0.8."""


def steep_roads(loaded: LoadedScenario) -> list[str]:
    """Return a sentence where the road of a scenario has an edge."""
    road = loaded.scenario.road
    if not isinstance(road, RoadSurface):
        return []
    place = road.placed(loaded.path.parent).steepest()
    if place is None or place.slope <= STEEPEST:
        return []
    return [
        f"warning: the road rises or falls by {place.slope:.3g} m a metre at x = "
        f"{shown(place.x, 'm')}: a wheel that touches the ground in one point does not feel such "
        "an edge as a tyre does; take 'road: {kind: obstacles, ...}', whose tyre envelops edges, "
        "or let it envelop this road by 'road: {kind: enveloped, road: ...}'"
    ]
