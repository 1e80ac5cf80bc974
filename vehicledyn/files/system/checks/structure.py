"""Checks of what parts of a system file do to each other: names, cuts and constraints in vain."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from vehicledyn.base.problems import Place
from vehicledyn.files.expressions.expressions import Expression
from vehicledyn.files.system.cuts import CutSet
from vehicledyn.files.system.joints import Coordinate
from vehicledyn.files.system.sets import SystemFile

Problems = Iterator[tuple[Place, str]]
_WITH_CHANNELS = (
    "cuts",
    "constraints",
    "links",
    "bushings",
    "springs",
    "forces",
    "wrenches",
    "elements",
    "wheels",
    "rail_wheels",
)


def structure_problems(file: SystemFile, coordinates: dict[str, Coordinate]) -> Problems:
    """Yield parts named like a coordinate, cuts of one body, constraints on nothing.

    Parameters
    ----------
    file
        The file, repetition and mirror images carried out.
    coordinates
        All coordinates by name.
    """
    channels = {f"{name}{tail}" for name in coordinates for tail in ("", "_rate")}
    for section in (*_WITH_CHANNELS, "sensors"):
        for name in getattr(file, section):
            if name in channels:
                yield (section, name), f"the name is taken: a coordinate or its rate is '{name}'"
    for name, cut in file.cuts.items():
        if isinstance(cut, CutSet) and cut.a.body == cut.b.body:
            words = f"both places are on '{cut.a.body}', which nothing can move against itself"
            yield ("cuts", name), f"{words}; a cut joins two bodies"
    for name, constraint in file.constraints.items():
        zero = getattr(constraint, "zero", None)
        if isinstance(zero, Expression) and not _moves(zero, constraint, channels):
            words = "names no coordinate, rate or point of a body that could make it zero"
            yield ("constraints", name, "zero"), words


def _moves(zero: Expression, constraint: Any, channels: set[str]) -> bool:
    points = getattr(constraint, "points", {})
    of_points = {*points, *(f"{point}_velocity" for point in points)}
    names = {part for name in zero.names for part in (name, name.rpartition(".")[0])}
    return not names.isdisjoint(channels) or not names.isdisjoint(of_points)


def given_twice(value: Any) -> list[tuple[tuple[str, ...], str]]:
    """Return the entries of a nested mapping whose dotted name occurs before, with places."""
    found: list[tuple[tuple[str, ...], str]] = []
    seen: set[str] = set()
    for place, name in _leaves(value, ()):
        if name in seen:
            found.append((place, f"'{name}' is given twice"))
        seen.add(name)
    return found


def _leaves(value: Any, place: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], str]]:
    if isinstance(value, dict):
        for key, item in value.items():
            yield from _leaves(item, (*place, str(key)))
    elif place:
        yield place, ".".join(place)
