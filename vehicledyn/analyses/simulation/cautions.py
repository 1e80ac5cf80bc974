"""What a scenario's road and path are not as one may think: gaps in files, splines that dip."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.road.surfaces.surface import RoadSurface

if TYPE_CHECKING:
    from vehicledyn.files.scenario import LoadedScenario


def cautions(loaded: LoadedScenario) -> list[str]:
    """Return a warning where the road's file lacks heights, and a note where the path dips."""
    road, folder = loaded.scenario.road, loaded.path.parent
    if road is None:  # that of the system's file
        written = loaded.written
        road, folder = getattr(getattr(written, "file", None), "road", None), written.path.parent
    gaps = road.placed(folder).gaps() if isinstance(road, RoadSurface) else ""
    look = getattr(loaded.scenario.manoeuvre, "caution", None)
    found = [gaps and f"warning: {gaps}", "" if look is None else look()]
    return [words for words in found if words]
