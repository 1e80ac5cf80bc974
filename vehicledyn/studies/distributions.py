"""Distributions of parameters as studies give them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from vehicledyn.analyse.uncertainty import Distribution, normal, triangular, uniform
from vehicledyn.base.errors import InputError
from vehicledyn.base.units import to_si

_LAWS: dict[str, tuple[Any, tuple[str, ...]]] = {
    "normal": (normal, ("mean", "deviation")),
    "uniform": (uniform, ("from", "to")),
    "triangular": (triangular, ("from", "mode", "to")),
}


def read_law(group: str, name: str, given: Mapping[str, Any], unit: str) -> Distribution:
    """Return the distribution of a parameter, an entry of a group of a study, in SI.

    Raises
    ------
    InputError
        If its kind is unknown or its numbers are not those of the kind.
    """
    kind, place = given.get("kind"), f"{group}.{name}"
    if not isinstance(kind, str) or kind not in _LAWS:
        known = ", ".join(_LAWS)
        raise wrong(place, f"kind '{kind!s:.40}' is unknown; known are {known}")
    make, fields = _LAWS[kind]
    if set(given) != {"kind", *fields}:
        raise wrong(place, f"a {kind} distribution has {', '.join(fields)}")
    try:
        numbers = [to_si(given[item], unit) for item in fields]
    except InputError as error:
        raise wrong(place, str(error)) from None
    ordered = numbers[1] > 0.0 if kind == "normal" else numbers == sorted(set(numbers))
    if not ordered:
        raise wrong(place, "its numbers must grow, a deviation be above zero")
    found: Distribution = make(*numbers)
    return found


def wrong(place: str, words: str) -> InputError:
    """Return the error of a key of a study."""
    return InputError(f"{place}: {words}", about=(place,))
