"""Equations without their expressions: what a run needs to know, as plain data.

The facts of some equations (names, units, starts, blocks, events) go into a file and come back
at once; the expressions are derived when one of them is first asked for.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import asdict, dataclass, fields
from typing import Any

from vehicledyn.symbolic.equations import (
    Block,
    Channel,
    Equations,
    Event,
    ParameterValue,
    Variable,
)

_ITEMS: dict[str, type[Any]] = {
    "states": Variable,
    "unknowns": Variable,
    "parameters": ParameterValue,
    "channels": Channel,
    "blocks": Block,
    "events": Event,
}
_PLAIN = ("name", "positions", "velocities", "structure")


class _Deferred:
    """Stands for an expression that is not derived yet."""


_DEFERRED = _Deferred()


@dataclass(frozen=True, kw_only=True)
class RememberedEquations(Equations):
    """Equations whose facts are known and whose expressions ``source`` derives when needed."""

    source: Callable[[], Equations]

    def __getattribute__(self, name: str) -> Any:
        """Return a fact, or an expression of the equations that the source derives."""
        value = super().__getattribute__(name)
        if value is _DEFERRED:
            return getattr(super().__getattribute__("source")(), name)
        return value


def facts_of(equations: Equations) -> dict[str, Any]:
    """Return all but the expressions as plain mappings, lists, texts and numbers."""
    plain = {name: getattr(equations, name) for name in _PLAIN}
    return plain | {name: [asdict(item) for item in getattr(equations, name)] for name in _ITEMS}


def equations_from(facts: dict[str, Any], source: Callable[[], Equations]) -> Equations:
    """Return equations of known facts.

    Parameters
    ----------
    facts
        From :func:`facts_of`, also by way of JSON.
    source
        Derives the same equations; called once at most for each expression asked for.
    """
    known: dict[str, Any] = {
        name: tuple(_item(kind, entry) for entry in facts[name]) for name, kind in _ITEMS.items()
    }
    known |= {
        "name": facts["name"],
        "structure": facts["structure"],
        "positions": tuple(facts["positions"]),
        "velocities": tuple(facts["velocities"]),
    }
    others: dict[str, Any] = {f.name: _DEFERRED for f in fields(Equations) if f.name not in known}
    return RememberedEquations(**known, **others, source=source)


def _item(kind: type[Any], entry: dict[str, Any]) -> Any:
    if kind is Event:
        return Event(**(entry | {"resets": tuple((a, b) for a, b in entry["resets"])}))
    return kind(**entry)
