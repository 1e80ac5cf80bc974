"""Changes of a scenario from outside the file, ``key=value``."""

from __future__ import annotations

import copy
import re
from collections.abc import Collection, Iterable
from typing import Any, NamedTuple

from vehicledyn.base.argument_names import setting
from vehicledyn.base.errors import InputError
from vehicledyn.base.problems import Place, Problem, refusal
from vehicledyn.base.registry import kinds
from vehicledyn.base.units import describe
from vehicledyn.base.yaml import parse_yaml
from vehicledyn.files.scenario.sources import Sources

_TYRES, _AXLES = "tyres", ("front", "rear")
_COMPONENTS = {"x": 0, "y": 1, "z": 2}


class Change(NamedTuple):
    """A value that a dotted key takes, and where it came from, for messages."""

    key: str
    value: Any
    origin: str


def apply_override(
    data: dict[str, Any], override: str, sources: Sources, groups: Collection[str] = ()
) -> Problem | None:
    """Change one value of a scenario's data in place and note where it came from.

    Parameters
    ----------
    data
        Content of the scenario file.
    override
        ``key=value`` with a dotted key; the value is YAML, such as ``36 km/h`` or ``[1, 2, 3]``.
    sources
        Where each value came from; the overridden place is entered.
    groups
        Names of the groups of the model's parameters; a key that begins with one of them is
        short for ``parameters.<key>``.

    Returns
    -------
    Problem or None
        What is wrong with the override, if anything.
    """
    change = read_override(override)
    if isinstance(change, Problem):
        return change
    return apply_change(data, change, sources, groups)


def read_override(override: str) -> Change | Problem:
    """Return the change that ``key=value`` asks for, or what is wrong with it."""
    key, equals, text = override.partition("=")
    option = setting(key.strip())
    if not equals or not _place(key):
        return Problem(setting(override), None, "", "write key=value, such as speed='36 km/h'")
    try:
        document = parse_yaml(text, option)
    except InputError:
        return Problem(option, None, "", f"'{text}' is not a YAML value; put a text in quotes")
    if document.problems:
        return Problem(option, None, "", document.problems[0].message)
    return Change(key.strip(), document.data, option)


def read_overrides(overrides: Iterable[str]) -> dict[str, Any]:
    """Return the values that texts ``key=value`` ask for, by their dotted keys.

    Raises
    ------
    InputError
        If any of them is no such text.
    """
    found = [read_override(item) for item in overrides]
    problems = [item for item in found if isinstance(item, Problem)]
    if problems:
        raise refusal(problems, problems[0].source)
    return {item.key: item.value for item in found if isinstance(item, Change)}


def apply_change(
    data: dict[str, Any], change: Change, sources: Sources, groups: Collection[str] = ()
) -> Problem | None:
    """Do the same as :func:`apply_override` with a value that was read already."""
    place = _place(change.key)
    if not place:
        return Problem(change.origin, None, "", "names no value of the scenario")
    if place[0] in groups:
        place = ("parameters", *place)
    place = _of_tyres(data, place)
    return _put(data, place, copy.deepcopy(change.value), change.origin, sources)


def _of_tyres(data: dict[str, Any], place: Place) -> Place:
    """Return the place in a scenario of a tyre's value, named as 'models show' names it.

    A vehicle's table of parameters has ``tyres.front`` and ``tyres.rear``, which a scenario has
    beside its 'parameters'; tyres that it gives once for both axles are parted.
    """
    if place[:2] == ("parameters", _TYRES) and data.get("model") in kinds("model"):
        place = place[1:]
    tyres = data.get(_TYRES)
    of_axle = place[0] == _TYRES and len(place) > 2 and place[1] in _AXLES
    if of_axle and isinstance(tyres, dict) and not any(axle in tyres for axle in _AXLES):
        data[_TYRES] = {axle: copy.deepcopy(tyres) for axle in _AXLES}
    return place


def _place(key: str) -> Place:
    return tuple(filter(None, re.split(r"[.\[\]]+", key.strip())))


def _put(data: Any, place: Place, value: Any, option: str, sources: Sources) -> Problem | None:
    holder, reached = data, 0
    for reached, step in enumerate(place):
        key = _step(holder, str(step))
        if key is None:
            name = ".".join(map(str, place[:reached]))
            words = f"'{name}' is {describe(holder)} and has no '{step}'"
            return Problem(option, None, "", words)
        place = (*place[:reached], key, *place[reached + 1 :])
        if reached == len(place) - 1:
            break
        holder = _inside(holder, key)
    holder[place[-1]] = value
    sources.override(place, option)
    return None


def _step(holder: Any, step: str) -> str | int | None:
    if isinstance(holder, dict):
        return step
    if not isinstance(holder, list):
        return None
    index = int(step) if step.isdecimal() else _COMPONENTS.get(step, -1)
    return index if 0 <= index < len(holder) else None


def _inside(holder: Any, key: str | int) -> Any:
    if isinstance(holder, dict) and holder.get(str(key)) is None:
        holder[str(key)] = {}
    return holder[key]
