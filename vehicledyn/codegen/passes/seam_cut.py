"""Cut the equations of a model apart from those of its surroundings, where these act on it.

    surroundings: (t, x, z, c) -> u and what is their own,    model: (t, x, z, u, c) -> the rest

The surroundings (driver, manoeuvre) hand the model the numbers u of its seam. The model's part of a
kernel is the same for all that hand it the same numbers, so it is compiled once for all of them.
What both need of the motion each computes for itself.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from vehicledyn.codegen.ir.sx_graph import Node, Rebuild, calls_of, read_nodes
from vehicledyn.codegen.passes.kernel_functions import (
    apart_in_functions,
    as_written,
    kernel_columns,
    operations_in,
)
from vehicledyn.symbolic.equations import Equations
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
    _graph: _Graph
    _own: dict[str, tuple[list[int | None], list[int]]]

    @cached_property
    def model(self) -> Half:
        """The functions of the model, of (t, x, z, u, c)."""
        e, graph = self.equations, self._graph
        given = [e.time, e.state, e.algebraic, graph.handed_symbols, e.parameter]
        values = graph.rebuilt(graph.order, handed=True)
        columns = [_column([values[k] for k in items]) for items in graph.model_results.values()]
        prepare, functions = apart_in_functions(
            list(graph.model_results), given, [[column] for column in columns], e.tables
        )
        return Half(prepare, functions)

    def surroundings(self, model_constants: int) -> Half:
        """Return the functions of the surroundings, of (t, x, z, c).

        ``model_constants`` is the number of constants of the model, which follow their own in c.
        """
        e, graph = self.equations, self._graph
        wanted = [k for handed, own in self._own.values() for k in (*handed, *own) if k is not None]
        values = graph.rebuilt(_ordered(graph.nodes, wanted, set()), handed=False)
        columns = [
            [_column([0.0 if k is None else values[k] for k in items]) for items in pair]
            for pair in self._own.values()
        ]
        given = [e.time, e.state, e.algebraic, e.parameter]
        prepare, functions = apart_in_functions(
            list(self._own), given, columns, e.tables, room=model_constants
        )
        return Half(prepare, functions)


@dataclass(frozen=True)
class _Graph:
    """All values of some equations, and those of the model in their order of computation."""

    function: Any
    inputs: list[Any]
    nodes: list[Node]
    places: dict[int, int]
    order: list[int]
    model_results: dict[str, list[int]]
    handed_symbols: Any

    def rebuilt(self, order: Iterable[int], *, handed: bool) -> dict[int, Any]:
        """Return the expressions of values; with ``handed`` symbols stand for what is handed."""
        with as_written():
            rebuild = Rebuild(self.function, self.inputs, self.nodes)
            found: dict[int, Any] = {}
            if handed:
                found |= {value: self.handed_symbols[k] for value, k in self.places.items()}
            for value in order:
                found[value] = rebuild.value(self.nodes[value], found)
        return found


def cut_at_seam(equations: Equations) -> SeamCut | None:
    """Return equations cut at their seam; None where there is none, or the model is small."""
    import casadi

    e = equations
    if e.seam is None:
        return None
    names, columns, wave_starts = kernel_columns(e)
    inputs = [e.time, e.state, e.algebraic, e.parameter]
    dense = [casadi.densify(casadi.SX(item)) for item in (*columns, e.seam.values)]
    with as_written():
        function = casadi.Function("all", inputs, casadi.cse(dense))
    if function.n_instructions() < _LARGE:
        return None
    nodes, results = read_nodes(function)
    handed = _handed(e.seam.names, nodes, sorted(results[-1]))
    values = {
        name: [value for _, value in sorted(found)]
        for name, found in zip(names, results, strict=False)
    }
    owned = {"rates": [s.name for s in e.states], "outputs": [c.name for c in e.channels]}
    own = {
        name: [
            k
            for k, value in enumerate(items)
            if value in handed or (name in owned and e.seam.owns(owned[name][k]))
        ]
        for name, items in values.items()
    }
    model = {
        name: [k for k in range(len(items)) if k not in set(own[name])]
        for name, items in values.items()
    }
    model_results = {name: [values[name][k] for k in model[name]] for name in names}
    needs = {
        name: handed.keys() & _reached(nodes, items, set(handed))
        for name, items in model_results.items()
    }
    used = sorted(set().union(*needs.values()), key=lambda value: handed[value])
    order = _ordered(nodes, [k for items in model_results.values() for k in items], set(used))
    if len(order) < _LARGE:
        return None
    places = {value: k for k, value in enumerate(used)}
    graph = _Graph(
        function,
        inputs,
        nodes,
        places,
        order,
        model_results,
        casadi.SX.sym("handed", len(used)),
    )
    return SeamCut(
        e,
        wave_starts,
        _key(e, graph),
        model,
        own,
        tuple(handed[value] for value in used),
        graph,
        {
            name: (
                [value if value in needs[name] else None for value in used],
                [values[name][k] for k in own[name]],
            )
            for name in names
        },
    )


def _handed(
    names: tuple[str, ...], nodes: list[Node], results: list[tuple[int, int]]
) -> dict[int, str]:
    """Return the values of the seam with their names.

    Signs and conditions of a value go over to its sums and products, so it may be met without.
    """
    import casadi

    taken_over = {casadi.OP_NEG, casadi.OP_IF_ELSE_ZERO}
    found: dict[int, str] = {}
    stack = [(name, value) for name, (_, value) in zip(names, results, strict=True)]
    while stack:
        name, value = stack.pop()
        code, operands, _ = nodes[value]
        if code != casadi.OP_CONST:
            found.setdefault(value, name)
        if code in taken_over:
            stack += [(f"{name}, {k}", operand) for k, operand in enumerate(operands)]
    return found


def _column(items: list[Any]) -> Any:
    import casadi

    return casadi.vertcat(casadi.SX(0, 1), *items)


def _reached(nodes: list[Node], values: Iterable[int], ends: set[int]) -> set[int]:
    """Return all that values are made from, up to and with some ends."""
    found: set[int] = set()
    stack = list(values)
    while stack:
        value = stack.pop()
        if value in found:
            continue
        found.add(value)
        if value not in ends:
            stack += _operands(nodes[value])
    return found


def _operands(node: Node) -> tuple[int, ...]:
    import casadi

    return () if node[0] == casadi.OP_INPUT else node[1]


def _ordered(nodes: list[Node], values: Iterable[int], ends: set[int]) -> list[int]:
    """Return all that values are made from but the ends, each behind what it is made from.

    The order follows from the values alone, whatever else the nodes hold.
    """
    order: list[int] = []
    done = set(ends)
    for first in values:
        stack = [(first, False)]
        while stack:
            value, is_ready = stack.pop()
            if is_ready:
                order.append(value)
            elif value not in done:
                done.add(value)
                stack.append((value, True))
                stack += [(k, False) for k in reversed(_operands(nodes[value])) if k not in done]
    return order


def _key(equations: Equations, graph: _Graph) -> str:
    """Return a text that is equal for models that are computed alike."""
    import casadi

    nodes = graph.nodes
    calls = {k: _identity(item, equations) for k, item in calls_of(graph.function, nodes).items()}
    number: dict[int, object] = {value: f"u{k}" for value, k in graph.places.items()}
    lines: list[object] = []
    for value in graph.order:
        code, operands, detail = nodes[value]
        if code != casadi.OP_INPUT:
            operands = tuple(number[k] for k in operands)  # type: ignore[misc]
        number[value] = len(lines)
        lines.append((code, operands, calls[int(detail)] if code == casadi.OP_CALL else detail))
    results = {name: [number[k] for k in items] for name, items in graph.model_results.items()}
    orders = [table.order for table in equations.tables]
    sizes = len(graph.places), len(equations.parameters) if orders else 0
    facts = (casadi.CasadiMeta.version(), sizes, orders, results, lines)
    return hashlib.sha256(repr(facts).encode()).hexdigest()


def _identity(called: Any, equations: Equations) -> object:
    """Return what distinguishes a called function: a table by its number, another by its text."""
    table = table_of(called)
    if table is None:
        return str(called.serialize())
    return [item.identity for item in equations.tables].index(table.identity)
