"""Report heights that the file of a road lacks."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.road.surfaces.surface import RoadSurface

if TYPE_CHECKING:
    from vehicledyn.files.scenario import LoadedScenario


def road_gaps(loaded: LoadedScenario) -> list[str]:
    """Return a sentence where the road's file lacks heights: how many, where the first is."""
    road = loaded.scenario.road
    words = road.placed(loaded.path.parent).gaps() if isinstance(road, RoadSurface) else ""
    return [f"warning: {words}"] if words else []
