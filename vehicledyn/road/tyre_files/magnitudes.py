"""Sizes that no tyre has: what a tyre property file says in other units than its header."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from vehicledyn.base.problems import Mark, Problem
from vehicledyn.base.units import shown
from vehicledyn.road.tyre_files.lines import Assignment


class _Size(NamedTuple):
    """Least and largest value of a quantity in SI units, and the header's lines behind it."""

    least: float
    most: float
    unit: str
    header: str


_PRESSURE = _Size(
    5e3, 5e6, "Pa", "PRESSURE (where that is missing, FORCE over LENGTH squared: N and mm make MPa)"
)
_SIZES = {
    "UNLOADED_RADIUS": _Size(0.01, 5.0, "m", "LENGTH"),
    "LONGVL": _Size(0.1, 300.0, "m/s", "LENGTH and TIME"),
    "ALPMAX": _Size(0.03, 7.0, "rad", "ANGLE"),
    "CAMMAX": _Size(0.0, 7.0, "rad", "ANGLE"),
    **dict.fromkeys(("INFLPRES", "NOMPRES", "IP", "IP_NOM"), _PRESSURE),
}
"""From the tyres of model cars to those of aircraft and of dumpers in mines."""

_SMALLEST_CONTACT, _LARGEST_CONTACT = 100.0, 5e6
"""Bounds of the nominal load over the square of the radius [Pa]: 26 kPa of a car's tyre."""


def implausible(
    found: Mapping[str, float], entries: Mapping[str, Assignment], source: str
) -> list[Problem]:
    """Return what no tyre can have after conversion to SI units, each with its line.

    Parameters
    ----------
    found
        Numbers of the file in SI units, by name; those at or below zero are not looked at.
    entries
        Lines of the file, by name.
    source
        Name of the file.
    """
    names = [name for name in (*_SIZES, "FNOMIN") if name in entries and found.get(name, 0.0) > 0.0]
    return [
        Problem(source, Mark(entries[name].line, 1), name, words)
        for name in names
        for words in _wrong(name, found)
    ]


def _wrong(name: str, found: Mapping[str, float]) -> Iterator[str]:
    value = found[name]
    size = _SIZES.get(name)
    if size is not None and not size.least <= value <= size.most:
        low, high = shown(size.least, size.unit), shown(size.most, size.unit)
        yield (
            f"is {value:.4g} {size.unit} by the file's units; tyres have {low} to {high}: check "
            f"[UNITS] {size.header}"
        )
    radius = found.get("UNLOADED_RADIUS", 0.0)
    of_radius = _SIZES["UNLOADED_RADIUS"]
    if name != "FNOMIN" or not of_radius.least <= radius <= of_radius.most:
        return
    if not _SMALLEST_CONTACT <= value / radius**2 <= _LARGEST_CONTACT:
        yield (
            f"is {value:.4g} N by the file's units, on a radius of {radius:.4g} m; no tyre carries "
            "that: check [UNITS] FORCE and LENGTH"
        )
