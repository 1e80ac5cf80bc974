"""Equations as plain data: what a run needs to know of them, and their expressions as a text.

The facts of some equations (names, units, starts, blocks, events, tables) go into a file and come
back at once. Their expressions come back from a text, too, or they are derived when one of them is
first asked for.
"""

from __future__ import annotations

import base64
import zlib
from collections.abc import Callable
from dataclasses import asdict, dataclass, fields, replace
from typing import TYPE_CHECKING, Any

from vehicledyn.symbolic.equations import (
    Attitude,
    Block,
    Channel,
    Equations,
    Event,
    ParameterValue,
    Seam,
    Variable,
)
from vehicledyn.symbolic.shared import know_shared

if TYPE_CHECKING:
    from vehicledyn.symbolic.constrained_equations import ConstrainedEquations
    from vehicledyn.symbolic.motion_residuals import MotionResiduals
    from vehicledyn.symbolic.tables import CurveTable

_ITEMS: dict[str, type[Any]] = {
    "states": Variable,
    "unknowns": Variable,
    "parameters": ParameterValue,
    "channels": Channel,
    "blocks": Block,
    "events": Event,
    "attitudes": Attitude,
}
_PLAIN = ("name", "positions", "velocities", "structure")
_EXPRESSIONS = ("time", "state", "algebraic", "parameter", "rate", "residual", "output", "event")
_OPTIONAL = ("slopes", "reset")


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
    plain["tables"] = [_table_facts(table) for table in equations.tables]
    return plain | {name: [asdict(item) for item in getattr(equations, name)] for name in _ITEMS}


def expressions_of(equations: Equations) -> dict[str, Any]:
    """Return the expressions of equations as a text, and what they are."""
    import casadi

    e = equations
    names = [*_EXPRESSIONS, *(name for name in _OPTIONAL if getattr(e, name) is not None)]
    packed = [casadi.SX(getattr(e, name)) for name in names]
    found: dict[str, Any] = {"names": names}
    if e.seam is not None:
        packed += [casadi.SX(getattr(e.seam.opened, name)) for name in names]
        packed += [casadi.SX(e.seam.symbols), casadi.SX(e.seam.values)]
        found["seam"] = {"names": e.seam.names, "parts": e.seam.parts}
    serializer = casadi.StringSerializer()
    serializer.pack(packed)
    content = zlib.compress(serializer.encode().encode("utf-8"), 1)
    return found | {"content": base64.b64encode(content).decode("ascii")}


def whole_equations(
    facts: dict[str, Any],
    expressions: dict[str, Any],
    constrained: Callable[[], ConstrainedEquations] | None,
    motion_residuals: Callable[[], MotionResiduals] | None = None,
) -> Equations:
    """Return equations of known facts and expressions.

    Parameters
    ----------
    facts, expressions
        From :func:`facts_of` and :func:`expressions_of`, also by way of JSON.
    constrained
        Derives the same motion as residuals with multipliers.
    motion_residuals
        Derives the same accelerations as residuals.

    Raises
    ------
    ValueError, RuntimeError, LookupError, TypeError
        If the data are none of equations.
    """
    import casadi

    try:
        content = zlib.decompress(base64.b64decode(expressions["content"])).decode("utf-8")
    except zlib.error as error:
        raise ValueError(f"no expressions: {error}") from None
    found = casadi.StringDeserializer(content).unpack()
    known = _known(facts)
    for table in known["tables"]:
        table.announce()
    know_shared(found)
    names = expressions["names"]
    given = dict(zip(names, found, strict=False))
    whole = Equations(**known, **given, constrained=constrained, motion_residuals=motion_residuals)
    seam = expressions.get("seam")
    if seam is None:
        return whole
    opened = replace(whole, **dict(zip(names, found[len(names) : -2], strict=True)))
    *_, symbols, values = found
    parts = tuple(seam["parts"])
    return replace(whole, seam=Seam(tuple(seam["names"]), symbols, values, parts, opened))


def equations_from(facts: dict[str, Any], source: Callable[[], Equations]) -> Equations:
    """Return equations of known facts.

    Parameters
    ----------
    facts
        From :func:`facts_of`, also by way of JSON.
    source
        Derives the same equations; called once at most for each expression asked for.
    """
    known = _known(facts)
    others: dict[str, Any] = {f.name: _DEFERRED for f in fields(Equations) if f.name not in known}
    return RememberedEquations(**known, **others, source=source)


def _known(facts: dict[str, Any]) -> dict[str, Any]:
    """Return what equations have besides expressions."""
    known: dict[str, Any] = {
        name: tuple(_item(kind, entry) for entry in facts[name]) for name, kind in _ITEMS.items()
    }
    return known | {
        "name": facts["name"],
        "structure": facts["structure"],
        "positions": tuple(facts["positions"]),
        "velocities": tuple(facts["velocities"]),
        "tables": tuple(_table(entry) for entry in facts["tables"]),
    }


def _item(kind: type[Any], entry: dict[str, Any]) -> Any:
    if kind is Event:
        pairs = {key: tuple((a, b) for a, b in entry[key]) for key in ("resets", "guesses")}
        return Event(**(entry | pairs))
    if kind is Attitude:
        return Attitude(tuple(entry["quaternion"]), tuple(entry["velocity"]))
    return kind(**entry)


def _table_facts(table: CurveTable) -> dict[str, Any]:
    """Return a table as plain data; its numbers as a text, which is read far faster than a list."""
    numbers = base64.b64encode(table.coefficients.astype("<f8").tobytes()).decode("ascii")
    return {
        "name": table.name,
        "start": table.start,
        "step": table.step,
        "order": table.order,
        "numbers": numbers,
    }


def _table(facts: dict[str, Any]) -> CurveTable:
    import numpy as np

    from vehicledyn.symbolic.tables import CurveTable

    numbers = np.frombuffer(base64.b64decode(facts["numbers"]), dtype="<f8")
    coefficients = numbers.reshape(-1, facts["order"] + 1)
    return CurveTable(facts["name"], facts["start"], facts["step"], coefficients)
