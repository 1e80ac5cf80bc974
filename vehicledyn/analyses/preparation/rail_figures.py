"""Figures of a vehicle on rails: its wheel forces, how its axles run, what its floors feel."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from vehicledyn.results.assessment.comfort import DIRECTIONS
from vehicledyn.results.assessment.subjects import Subjects, find_subjects

MOST_PANELS = 8
"""Panels of one figure; a vehicle with more axles has further figures."""

MOST_LINES = 4
"""Lines of one panel."""

_WHEELS = (
    ("Q", "Q", "wheel_loads", "Vertical wheel forces", "kN"),
    ("Y", "Y", "guiding_forces", "Lateral wheel forces", "kN"),
    ("wear_number", "Wear", "wear", "Wear numbers", "N"),
)
_AXLES = (
    ("lateral_shift", "Lateral shift", "mm"),
    ("angle_of_attack", "Angle of attack", "mrad"),
)
_CONTACT = ".contact_"
_CARRIED = ".track_"


def rail_figures(units: Mapping[str, str]) -> Iterator[dict[str, Any]]:
    """Yield descriptions of figures, none if no wheel runs on rails.

    First come lateral shifts and angles of attack with the curvature of the track, then wheel
    forces and wear, a panel for the wheels of each axle or for two lone ones, and accelerations.

    Parameters
    ----------
    units
        Units of the channels by name.
    """
    found = find_subjects(units)
    yield from _running(found, units)
    for word, short, name, title, unit in _WHEELS:
        panels = [
            _panel(f"{short}, {label}", unit, names)
            for label, wheels in _groups(found.axles)
            if (names := [n for wheel in wheels if (n := f"{wheel}.{word}") in units])
        ]
        yield from _figures(name, title, panels)
    panels = [
        _panel(sensor, "m/s^2", names)
        for sensor in found.sensors
        if (names := [n for word in DIRECTIONS if (n := f"{sensor}.{word}") in units])
    ]
    yield from _figures("accelerations", "Accelerations", panels)


def _groups(axles: Mapping[str, tuple[str, ...]]) -> Iterator[tuple[str, list[str]]]:
    """Yield what shares a panel, with its name: the wheels of an axle, or two lone ones."""
    for axle, wheels in axles.items():
        if len(wheels) > 1:
            yield axle, list(wheels)
    for pair in _batches((axle for axle, wheels in axles.items() if len(wheels) == 1), 2):
        same = itertools.takewhile(lambda letters: len(set(letters)) == 1, zip(*pair, strict=False))
        common = "".join(letters[0] for letters in same).rstrip("_. ")
        yield common or pair[0], [wheel for axle in pair for wheel in axles[axle]]


def _running(found: Subjects, units: Mapping[str, str]) -> Iterator[dict[str, Any]]:
    """Yield how the axles run; lone wheels are to either side, so their lines are arranged."""
    lone = any(len(wheels) == 1 for wheels in found.axles.values())
    panels = []
    for word, label, unit in _AXLES:
        names = [n for axle in found.axles if (n := f"{axle}.{word}") in units]
        batches = [names] if lone and names else _batches(names)
        panels += [_panel(label, unit, batch) for batch in batches]
    if panels:
        bends = found.bends[:MOST_LINES]
        panels += [_panel("Curvature", "1/km", bends)] if bends else []
        for figure in _figures("running", "How the axles run on the track", panels):
            yield {**figure, "arranged": lone}


def is_of_rails(name: str) -> bool:
    """Return whether a channel is a detail of a contact or of the motion of the track's frame."""
    return _CONTACT in name or _CARRIED in name


def _figures(name: str, title: str, panels: Sequence[dict[str, Any]]) -> Iterator[dict[str, Any]]:
    """Yield one figure, or several where there are too many panels for one."""
    parts = list(_batches(panels, MOST_PANELS))
    for k, part in enumerate(parts, start=1):
        of = f" ({k} of {len(parts)})" if len(parts) > 1 else ""
        number = f"_{k}" if len(parts) > 1 else ""
        yield {"name": name + number, "title": title + of, "kind": "time", "panels": part}


def _panel(label: str, unit: str, channels: Sequence[str]) -> dict[str, Any]:
    """Return a panel; each line is named by what is not in the names of all the others."""
    words = [name.split(".") for name in channels]
    parts_of = enumerate(zip(*words, strict=False))
    differing = [k for k, parts in parts_of if len(set(parts)) > 1][:1]
    labels = [".".join(parts[k] for k in differing) or parts[0] for parts in words]
    return {"label": label, "unit": unit, "channels": list(channels), "labels": labels}


def _batches(items: Iterable[Any], size: int = MOST_LINES) -> Iterator[list[Any]]:
    rest = iter(items)
    while batch := list(itertools.islice(rest, size)):
        yield batch
