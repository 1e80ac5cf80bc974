"""Wheels that are not of the size of the tyre whose property file they have."""

from __future__ import annotations

from collections.abc import Iterator

from vehicledyn.base.units import shown
from vehicledyn.multibody.model.system import System
from vehicledyn.road.tyres.file_tyre import FileTyre
from vehicledyn.road.wheel.road_wheel import RoadWheel
from vehicledyn.symbolic import ops

_APART = 0.02
"""Part of the radius by which a wheel differs from its tyre that is reported [1]."""

_KEYS = ("UNLOADED_RADIUS", "VERTICAL_STIFFNESS")


def unlike_tyres(system: System) -> Iterator[str]:
    """Yield a sentence for each size of wheels that have the property file of another size."""
    wheels = [part for part in system.parts if isinstance(part, RoadWheel)]
    entries = system.table.entries
    symbols = ops.column([entry.symbol for entry in entries])
    values = [entry.value for entry in entries]
    found: dict[tuple[str, str, str, str, str], list[str]] = {}
    for wheel in wheels:
        if not isinstance(wheel.tyre, FileTyre):
            continue
        of_file = [wheel.tyre.content.values.get(key) for key in _KEYS]
        worth = ops.numeric([symbols], ops.column([wheel.radius, wheel.stiffness]))(values)
        radius, stiffness = (float(value) for value in worth.ravel())
        if of_file[0] is None or abs(radius / of_file[0] - 1.0) <= _APART:
            continue
        sizes = (radius, "m"), (stiffness, "N/m"), (of_file[0], "m"), (of_file[1] or 0.0, "N/m")
        key = (wheel.tyre.path.name, *(shown(value, unit) for value, unit in sizes))
        found.setdefault(key, []).append(wheel.name)  # type: ignore[arg-type]
    for (file, radius_shown, stiffness_shown, file_radius, file_stiffness), names in found.items():
        yield (
            f"{', '.join(names)}: {file} is of a tyre of {file_radius} and {file_stiffness}, the "
            f"wheels of the model have {radius_shown} and {stiffness_shown}, which count; change "
            "the radius and the stiffness of the model if they are to be the tyre's"
        )
