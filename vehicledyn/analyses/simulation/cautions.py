"""What a road and a path are not as one may think: gaps in files, splines that swing aside."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from vehicledyn.road.surfaces.surface import RoadSurface

if TYPE_CHECKING:
    from vehicledyn.files.scenario.target import Target


def cautions(*targets: Target) -> list[str]:
    """Return warnings where roads' files lack heights, and notes where paths swing aside.

    ``targets`` are scenarios, and models by themselves, of which the file may name a road.
    """
    return list(dict.fromkeys(words for target in targets for words in _of(target)))


def _of(target: Target) -> Iterable[str]:
    scenario, written = target.choices, target.written
    road, folder = scenario and scenario.road, target.origin.parent
    if road is None:  # that of the system's file
        road, folder = getattr(written.file, "road", None), written.path.parent
    if isinstance(road, RoadSurface) and (gaps := road.placed(folder).gaps()):
        yield f"warning: {gaps}"
    look = getattr(scenario and scenario.manoeuvre, "caution", None)
    if look is not None and (dip := look()):
        yield dip
