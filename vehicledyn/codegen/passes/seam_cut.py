"""Cut the equations of a model apart from those of its surroundings, where these act on it.

    surroundings: (t, x, z, c) -> u and what is their own,    model: (t, x, z, u, c) -> the rest

The surroundings (driver, manoeuvre) hand the model the numbers u of its seam. The model's part of a
kernel is the same for all that hand it the same numbers, so it is compiled once for all of them.
What both need of the motion each computes for itself.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from vehicledyn.codegen.ir.sx_graph import calls_of, read_nodes
from vehicledyn.codegen.passes.kernel_functions import (
    apart_in_functions,
    as_written,
    event_expressions,
    kernel_columns,
    operations_in,
)
from vehicledyn.symbolic.equations import Equations, Seam
from vehicledyn.symbolic.tables import table_of

_LARGE = 4_000
"""Instructions of a model from which compiling it apart pays."""


@dataclass(frozen=True)
class Half:
    """One side of the seam: ``prepare`` p -> c, and the functions of a kernel by their names.

    Results of the model are columns; surroundings have two, u and what is their own.
    """

    prepare: Any
    functions: dict[str, Any]

    @property
    def operations(self) -> dict[str, int]:
        """Number of operations of prepare, rates, outputs and blocks."""
        counts = {name: operations_in(item) for name, item in self.functions.items()}
        return {
            "prepare": operations_in(self.prepare),
            "rates": counts["rates"],
            "outputs": counts["outputs"],
            "blocks": sum(count for name, count in counts.items() if name.startswith("wave_")),
        }


@dataclass(frozen=True)
class SeamCut:
    """Equations on both sides of their seam.

    ``model_key`` is equal for models that are computed alike. ``model_places`` and ``own_places``
    say which elements of each function's result are the model's and which the surroundings'.
    """

    equations: Equations
    wave_starts: tuple[int, ...]
    model_key: str
    model_places: dict[str, list[int]]
    own_places: dict[str, list[int]]
    handed: tuple[str, ...]
    _symbols: Any
    _model: dict[str, Any]
    _own: dict[str, tuple[Any, Any]]

    @cached_property
    def model(self) -> Half:
        """The functions of the model, of (t, x, z, u, c)."""
        e = self.equations
        given = [e.time, e.state, e.algebraic, self._symbols, e.parameter]
        columns = [[column] for column in self._model.values()]
        return Half(*apart_in_functions(list(self._model), given, columns, e.tables))

    def surroundings(self, model_constants: int) -> Half:
        """Return the functions of the surroundings, of (t, x, z, c).

        ``model_constants`` is the number of constants of the model, which follow their own in c.
        """
        e, names = self.equations, list(self._own)
        given = [e.time, e.state, e.algebraic, e.parameter]
        with as_written():
            flat = iter(_shared([item for pair in self._own.values() for item in pair]))
        columns = [(next(flat), next(flat)) for _ in names]
        return Half(*apart_in_functions(names, given, columns, e.tables, room=model_constants))


def cut_at_seam(equations: Equations) -> SeamCut | None:
    """Return equations cut at their seam; None where there is none, or the model is small."""
    import casadi

    e, seam = equations, equations.seam
    if seam is None:
        return None
    names, columns, wave_starts = kernel_columns(seam.opened)
    owned = _owned(e, seam)
    own = {name: owned.get(name, []) for name in names}
    model = {
        name: sorted(set(range(column.numel())).difference(own[name]))
        for name, column in zip(names, columns, strict=True)
    }
    with as_written():
        parts = _shared(
            [_rows(column, model[name]) for name, column in zip(names, columns, strict=True)]
        )
    needs = [_needed(column, seam) for column in parts]
    used = sorted(set().union(*needs), key=seam.names.__getitem__)
    symbols = _rows(seam.symbols, used)
    given = [e.time, e.state, e.algebraic, symbols, e.parameter]
    with as_written():
        function = casadi.Function("model", given, parts)
    if function.n_instructions() < _LARGE:
        return None
    ours = {"rates": e.rate, "outputs": e.output}
    ours |= dict(zip(("events", "resets"), event_expressions(e), strict=True))
    return SeamCut(
        e,
        wave_starts,
        _key(e, function, names, len(used)),
        model,
        own,
        tuple(seam.names[k] for k in used),
        symbols,
        dict(zip(names, parts, strict=True)),
        {
            name: (
                _column([seam.values[k] if k in needed else 0.0 for k in used]),
                _rows(ours[name], own[name]) if own[name] else _column([]),
            )
            for name, needed in zip(names, needs, strict=True)
        },
    )


def _owned(equations: Equations, seam: Seam) -> dict[str, list[int]]:
    """Return which elements of each function's result are those of the surroundings."""
    e = equations
    events = [k for k, event in enumerate(e.events) if seam.owns(event.name)]
    return {
        "rates": [k for k, state in enumerate(e.states) if seam.owns(state.name)],
        "outputs": [k for k, channel in enumerate(e.channels) if seam.owns(channel.name)],
        "events": events,
        "resets": [row for k in events for _, row in (*e.events[k].resets, *e.events[k].guesses)],
    }


def _needed(column: Any, seam: Seam) -> set[int]:
    """Return which of the symbols of a seam are in a column."""
    import casadi

    found = {item.element_hash() for item in casadi.symvar(column)}
    return {k for k in range(len(seam.names)) if seam.symbols[k].element_hash() in found}


def _shared(columns: list[Any]) -> list[Any]:
    """Return columns with what they have in common computed once."""
    import casadi

    return list(casadi.cse([casadi.densify(casadi.SX(item)) for item in columns]))


def _rows(column: Any, places: Sequence[int]) -> Any:
    return _column([column[k] for k in places])


def _column(items: list[Any]) -> Any:
    import casadi

    return casadi.vertcat(casadi.SX(0, 1), *items)


def _key(equations: Equations, function: Any, names: Sequence[str], n_handed: int) -> str:
    """Return a text that is equal for models that are computed alike."""
    import casadi

    nodes, results = read_nodes(function)
    calls = {k: _identity(item, equations) for k, item in calls_of(function, nodes).items()}
    lines = [
        (code, operands, calls[int(detail)] if code == casadi.OP_CALL else detail)
        for code, operands, detail in nodes
    ]
    orders = [table.order for table in equations.tables]
    sizes = n_handed, len(equations.parameters) if orders else 0
    found = [sorted(items) for items in results]
    facts = (casadi.CasadiMeta.version(), sizes, orders, list(names), found, lines)
    return hashlib.sha256(repr(facts).encode()).hexdigest()


def _identity(called: Any, equations: Equations) -> object:
    """Return what distinguishes a called function: a table by its number, another by its text."""
    table = table_of(called)
    if table is None:
        return str(called.serialize())
    return [item.identity for item in equations.tables].index(table.identity)
