"""What the names of a study of an optimal manoeuvre mean in its model."""

from __future__ import annotations

import fnmatch
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vehicledyn.analyse.optimal_control.problem import BoundedExpression, Control, PointExpression
from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.units import parse_unit, with_unit
from vehicledyn.symbolic.equations import Equations

PATH = {"path.distance": 0, "path.offset": 1}
_NORM = re.compile(r"norm\((.+)\)$")
_CALL = re.compile(r"(integral|integral_of_square|final)\((.+)\)$")
_INF = float("inf")


@dataclass(frozen=True)
class Names:
    """The names of a model's equations, of the controls and of the path."""

    equations: Equations
    controls: tuple[Control, ...]
    has_path: bool

    @property
    def states(self) -> dict[str, int]:
        """Indices of the states."""
        return {item.name: k for k, item in enumerate(self.equations.states)}

    def find(self, name: str) -> tuple[PointExpression, str]:
        """Return what a name means, with its SI unit.

        Raises
        ------
        InputError
            If nothing has the name.
        """
        if match := _NORM.match(name):
            parts = [self.find(part.strip()) for part in match[1].split(",")]
            if len({parse_unit(unit) for _, unit in parts}) != 1:
                raise InputError(f"'{name}' adds quantities of different units")
            return PointExpression(name, "square", parts=tuple(p for p, _ in parts)), parts[0][1]
        if name in PATH and self.has_path:
            return PointExpression(name, "path", PATH[name]), "m"
        groups: dict[str, Sequence[Any]] = {
            "control": self.controls,
            "state": self.equations.states,
            "unknown": self.equations.unknowns,
            "channel": self.equations.channels,
        }
        for kind, items in groups.items():
            for k, item in enumerate(items):
                if item.name == name:
                    return PointExpression(name, kind, k), item.unit
        known = dict.fromkeys(item.name for items in groups.values() for item in items)
        paths = list(PATH) * self.has_path
        raise InputError(unknown_name("state, channel or control", name, [*known, *paths]))

    def bounded(self, name: str, given: Any) -> BoundedExpression:
        """Return a quantity with the bounds that a study gives it.

        Raises
        ------
        InputError
            If there is no such quantity, or the bounds are none.
        """
        what, unit = self.find(name)
        low, high = bounds_of(given, unit)
        if what.kind == "square":
            if np.isfinite(low) or high < 0.0:
                raise InputError("has an upper bound 'to' only, not below zero")
            return BoundedExpression(what, -_INF, high**2)
        return BoundedExpression(what, low, high)

    def term(self, name: str, weight: float, powers: list[tuple[Any, ...]]) -> Any:
        """Return terms of the objective by their name: pairs of weight and what it is.

        ``powers`` are those of the controls that are forces.
        """
        if name in ("time", "effort", "smoothness"):
            return [(weight, (name,))]
        if name == "energy":
            if not powers:
                raise InputError(
                    "energy is that of controls that are forces on free coordinates, "
                    "'force:COORDINATE'; this study has none"
                )
            return [(weight, power) for power in powers]
        match = _CALL.match(name)
        if match is None:
            raise InputError(
                f"'{name}' is unknown; write time, effort, smoothness, energy, "
                "integral(NAME), integral_of_square(NAME) or final(NAME)"
            )
        word = "square" if match[1] == "integral_of_square" else match[1]
        return [(weight, (word, self.find(match[2])[0]))]

    def matching(self, pattern: str) -> list[int]:
        """Return the states of a pattern.

        Raises
        ------
        InputError
            If no state matches.
        """
        found = [k for n, k in self.states.items() if fnmatch.fnmatchcase(n, pattern)]
        if not found:
            raise InputError(unknown_name("state", pattern, self.states))
        return found


def bounds_of(given: Any, unit: str) -> tuple[float, float]:
    """Return the bounds that a value, "free" or a mapping with from and to gives, in SI.

    Raises
    ------
    InputError
        If it is none of these, or the bounds are crossed.
    """
    if given == "free":
        return -_INF, _INF
    if not isinstance(given, dict):
        value = _number(given, unit)
        if np.isinf(value):
            raise InputError("must be finite")
        return value, value
    if "from" not in given and "to" not in given:
        raise InputError("needs from, to or both")
    low = _number(given["from"], unit) if "from" in given else -_INF
    high = _number(given["to"], unit) if "to" in given else _INF
    if low > high:
        raise InputError(f"the bounds are crossed, from {low:g} to {high:g} {unit}")
    return low, high


def _number(given: Any, unit: str) -> float:
    value = with_unit(given, unit)
    if np.isnan(value):
        raise InputError("nan is no number")
    return value
