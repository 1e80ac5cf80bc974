"""Numbers without a unit where a quantity has one: refused, since nobody sees what they mean."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from vehicledyn.base.problems import Place, Problem
from vehicledyn.base.units import is_bare, is_pure, missing_unit
from vehicledyn.files.scenario.sources import Sources


def bare_numbers(
    data: Mapping[str, Any], units: Mapping[str, str], sources: Sources
) -> list[Problem]:
    """Return the problems of numbers that need a unit; zero is the same in all of them.

    Parameters
    ----------
    data
        Content of the scenario.
    units
        SI unit of each quantity by dotted name, those that the scenario does not give included.
    sources
        Where each value came from.
    """
    found = {
        place: missing_unit(value, unit)
        for name, unit in units.items()
        if not is_pure(unit)
        for above, quantity in _given(data, tuple(name.split(".")))
        for place, value in _numbers(quantity, above)
    }
    return [sources.problem(place, words) for place, words in found.items()]


def _given(data: Any, names: tuple[str, ...]) -> Iterator[tuple[Place, Any]]:
    """Yield place and value of a dotted name, if the data has it; names may hold dots."""
    if not names:
        yield (), data
    elif isinstance(data, list):
        index = int(names[0]) if names[0].isdecimal() else len(data)
        if index < len(data):
            yield from _below(index, data[index], names[1:])
    elif isinstance(data, Mapping):
        for count in range(1, len(names) + 1):
            key = ".".join(names[:count])
            if key in data:
                yield from _below(key, data[key], names[count:])
        if names[0] in ("front", "rear") and not {"front", "rear"} & set(data) and "kind" in data:
            yield from _given(data, names[1:])  # tyres: one for both axles


def _below(key: str | int, data: Any, names: tuple[str, ...]) -> Iterator[tuple[Place, Any]]:
    for place, value in _given(data, names):
        yield (key, *place), value


def _numbers(value: Any, place: Place) -> Iterator[tuple[Place, Any]]:
    """Yield the numbers in a quantity that have no unit: itself, or components of a vector."""
    if isinstance(value, Mapping):
        items: list[tuple[str | int, Any]] = list(value.items())
    elif isinstance(value, list | tuple):
        items = list(enumerate(value))
    else:
        items = []
        if is_bare(value):
            yield place, value
    for key, item in items:
        yield from _numbers(item, (*place, key))
