"""Distributions of parameters as studies give them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from vehicledyn.analyse.uncertainty import Distribution, normal, triangular, uniform
from vehicledyn.base.problems import Place
from vehicledyn.studies.mistakes import Mistakes

_LAWS: dict[str, tuple[Any, tuple[str, ...]]] = {
    "normal": (normal, ("mean", "deviation")),
    "uniform": (uniform, ("from", "to")),
    "triangular": (triangular, ("from", "mode", "to")),
}


def read_law(mistakes: Mistakes, place: Place, given: Any, unit: str) -> Distribution | None:
    """Return the distribution of a parameter in SI, None and problems if it is none.

    Parameters
    ----------
    mistakes
        What is wrong in the study so far.
    place
        Where it stands in the study.
    given
        Its ``kind`` and the numbers of that kind.
    unit
        SI unit of the parameter.
    """
    if not isinstance(given, Mapping):
        mistakes.wrong(place, "expected a distribution, a mapping with kind")
        return None
    kind = given.get("kind")
    if not isinstance(kind, str) or kind not in _LAWS:
        known = ", ".join(_LAWS)
        mistakes.wrong(place, f"kind '{kind!s:.40}' is unknown; known are {known}")
        return None
    make, fields = _LAWS[kind]
    if set(given) != {"kind", *fields}:
        mistakes.wrong(place, f"a {kind} distribution has {', '.join(fields)}")
        return None
    numbers = [mistakes.number((*place, item), given[item], unit) for item in fields]
    if not all(map(math.isfinite, numbers)):
        return None
    ordered = numbers[1] > 0.0 if kind == "normal" else numbers == sorted(set(numbers))
    if not ordered:
        mistakes.wrong(place, "its numbers must grow, a deviation be above zero")
        return None
    found: Distribution = make(*numbers)
    return found
