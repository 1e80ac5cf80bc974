"""What a scenario changes of a system file: parameters and starts."""

from __future__ import annotations

import copy
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from vehicledyn.base.errors import nearest_name
from vehicledyn.base.problems import Place
from vehicledyn.base.units import describe, is_pure, missing_unit
from vehicledyn.files.expressions.fields import flattened
from vehicledyn.files.expressions.parameters import Parameters, is_long, read_parameters

_COMPONENTS = ("x", "y", "z")
_VECTOR = 3


@dataclass
class Changes:
    """Places that a scenario gave, what is wrong with them, and the parameters as they were.

    ``needs_units`` notes numbers without unit; of scenarios others look at those.
    """

    before: Parameters
    needs_units: bool = False
    given: set[Place] = field(default_factory=set)
    problems: list[tuple[Place, str]] = field(default_factory=list)

    def gave(self, place: Place) -> bool:
        """Return whether the scenario gave the value at a place, or what holds it."""
        return any(place[: len(g)] == g for g in self.given)


def apply(data: dict[str, Any], given: dict[str, Any]) -> Changes:
    """Change a file's data in place.

    Parameters
    ----------
    data
        The file's data.
    given
        Changes under "parameters", nested like the file's, vectors also by component; and
        under "initial".
    """
    changes = Changes(read_parameters(data.get("parameters")))
    parameters = given.get("parameters") or {}
    declared = data.get("parameters") or {}
    if isinstance(parameters, dict) and parameters and isinstance(declared, dict):
        own = copy.deepcopy(declared)
        data["parameters"] = own
        merge(own, parameters, ("parameters",), changes)
    starts = given.get("initial") or {}
    if isinstance(starts, dict):
        known = data.get("initial")
        own = flattened(known) if isinstance(known, dict) else {}
        data["initial"] = {**own, **flattened(starts)}
        changes.given |= {("initial", name) for name in flattened(starts)}
    return changes


def changed_units(changes: Changes, after: Parameters) -> Iterator[tuple[Place, str]]:
    """Yield the parameters that a change gives another dimension."""
    before = {n: m for e in changes.before.entries for n, _, m, _ in e.components}
    for entry in after.entries:
        for name, _, measure, _ in entry.components:
            place: Place = ("parameters", *name.split("."))
            old = before.get(name)
            if old is not None and not measure.replaces(old) and changes.gave(place):
                new, wanted = measure.unit, old.unit
                yield place, f"this is in {new}, the parameter is a quantity in {wanted}"


def merge(own: dict[str, Any], change: dict[str, Any], place: Place, changes: Changes) -> None:
    """Change a section of parameters in place; ``changes`` notes what was given and is wrong."""
    for key, value in change.items():
        here = (*place, key)
        if key not in own:
            guess = nearest_name(key, own)
            hint = f"; did you mean '{guess}'?" if guess else "."
            words = f"no such parameter{hint} Known: {', '.join(own) or 'none'}"
            changes.problems.append((here, words))
        else:
            own[key] = _merged(own[key], value, here, changes)


def _merged(old: Any, new: Any, place: Place, changes: Changes) -> Any:
    if is_long(old):
        return {**old, "value": _merged(old["value"], new, place, changes)}
    if isinstance(old, dict) and isinstance(new, dict):
        merge(old, new, place, changes)
        return old
    if isinstance(old, dict):
        changes.problems.append(
            (place, f"this is a group; expected a mapping, found {describe(new)}")
        )
        return old
    if isinstance(old, list) and len(old) == _VECTOR and isinstance(new, dict):
        return _components(old, new, place, changes)
    changes.given.add(place)
    if isinstance(new, list):
        parts = zip(new, _COMPONENTS, strict=False)
        return [_with_unit(item, (*place, axis), changes) for item, axis in parts]
    return _with_unit(new, place, changes)


def _with_unit(value: Any, place: Place, changes: Changes) -> Any:
    """Return a bare number with the SI unit that the parameter has.

    That of a calculated parameter is multiplied by one, so that it counts as calculated too.
    """
    known = {n: m for e in changes.before.entries for n, _, m, _ in e.components}
    old = known.get(".".join(map(str, place[1:])))
    is_bare = isinstance(value, int | float) and not isinstance(value, bool)
    if old is None or old.unit == "1" or not is_bare:
        return value
    if changes.needs_units and value and not is_pure(old.unit):
        changes.problems.append((place, missing_unit(value, old.unit)))
    return f"{value!r} {old.unit}" if old.exact else f"1 * {value!r} {old.unit}"


def _components(old: list[Any], new: dict[str, Any], place: Place, changes: Changes) -> list[Any]:
    vector = list(old)
    for key, value in new.items():
        if key in _COMPONENTS:
            vector[_COMPONENTS.index(key)] = _with_unit(value, (*place, key), changes)
            changes.given.add((*place, key))
        else:
            words = f"unknown component. Known: {', '.join(_COMPONENTS)}"
            changes.problems.append(((*place, key), words))
    return vector
