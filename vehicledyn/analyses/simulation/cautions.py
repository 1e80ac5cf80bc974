"""What a road, a path or a tyre is not as one may think: gaps, splines that swing, modes."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

from vehicledyn.road.surfaces.surface import RoadSurface
from vehicledyn.road.tyres.asked_modes import asked
from vehicledyn.road.tyres.file_tyre import FileTyre

if TYPE_CHECKING:
    from vehicledyn.files.scenario.target import Target


def cautions(*targets: Target) -> list[str]:
    """Return warnings where roads lack heights, notes where paths swing or tyres act in part.

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
    relaxed = scenario is not None and scenario.relaxation is not None
    for tyre in _file_tyres(target):
        yield from asked(tyre, relaxed=relaxed)


def _file_tyres(target: Target) -> Iterable[FileTyre]:
    """Yield the tyres of property files of a scenario, or of its model's wheels."""
    scenario, folder = target.choices, target.origin.parent
    if scenario is not None and scenario.tyres is not None:
        chosen = [scenario.tyres.front, scenario.tyres.rear]
    else:
        folder, wheels = target.written.path.parent, getattr(target.written.file, "wheels", {})
        chosen = [wheel.tyre for wheel in wheels.values()]
    for tyre in chosen:
        if isinstance(tyre, FileTyre):
            yield tyre.placed(folder)
