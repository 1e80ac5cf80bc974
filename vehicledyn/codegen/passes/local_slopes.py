"""Derivatives of every operation of an SX function by its operands, as a graph.

A node is an input element, an operation or an output element; an edge from a node to one computed
of it carries the derivative of the one by the other, an expression in the function's inputs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

from vehicledyn.codegen.ir.sx_graph import RESULT, Rebuild, read_nodes

_STEPS = [
    *("OP_LT", "OP_LE", "OP_EQ", "OP_NE", "OP_NOT", "OP_AND", "OP_OR"),
    *("OP_SIGN", "OP_FLOOR", "OP_CEIL"),
]
"""Operations whose derivative is zero wherever it exists."""


@dataclass(frozen=True)
class SlopeGraph:
    """The graph of a function with one column of results.

    ``before[v]`` maps the nodes that node v is computed of to the derivatives by them.
    ``sources`` maps (input, element) to a node, ``targets`` are the nodes of the elements of the
    result, in their order; ``values`` are these elements.
    """

    before: list[dict[int, Any]]
    sources: dict[tuple[int, int], int]
    targets: list[int]
    values: Any


def slope_graph(function: Any, inputs: list[Any], moving: Callable[[int], bool]) -> SlopeGraph:
    """Return the graph of a function that calls nothing but cells of tables.

    Parameters
    ----------
    function
        A ``casadi.Function`` of SX expressions with one result, a column.
    inputs
        Columns of symbols for its inputs, in which the derivatives are expressed.
    moving
        Whether derivatives by an input are wanted, by its number.
    """
    import casadi

    nodes, results = read_nodes(function)
    rebuild = Rebuild(function, inputs, nodes)
    values: list[Any] = []
    before: list[dict[int, Any]] = []
    sources: dict[tuple[int, int], int] = {}
    moves: list[bool] = []
    for number, (code, operands, detail) in enumerate(nodes):
        values.append(rebuild.value((code, operands, detail), values))
        if code == casadi.OP_INPUT:
            moves.append(moving(operands[0]))
            before.append({})
            if moves[-1]:
                sources[operands[0], operands[1]] = number
            continue
        edges: dict[int, Any] = {}
        if code not in (casadi.OP_CONST, casadi.OP_CALL, RESULT):
            given = [values[item] for item in operands]
            for place, item in enumerate(operands):
                slope = local_slope(code, place, given, values[-1]) if moves[item] else None
                if slope is not None:
                    edges[item] = edges[item] + slope if item in edges else slope
        edges = {item: slope for item, slope in edges.items() if not slope.is_zero()}
        before.append(edges)
        moves.append(bool(edges))
    targets = []
    for _, value in sorted(results[0]):
        targets.append(len(before))
        before.append({value: casadi.SX(1.0)} if moves[value] else {})
    return SlopeGraph(before, sources, targets, rebuild.results(results, values)[0])


def local_slope(code: int, place: int, given: list[Any], value: Any) -> Any:
    """Return the derivative of an operation by one of its operands, None where it is zero."""
    import casadi

    if code in _step_codes() or (code == casadi.OP_IF_ELSE_ZERO and place == 0):
        return None
    rule = _rules().get(code)
    if rule is not None:
        return casadi.SX(rule(place, given, value))
    return _template(code, place, len(given))(*given)


@cache
def _rules() -> dict[int, Callable[[int, list[Any], Any], Any]]:
    """Return the derivatives of frequent operations: of operand, operands and result."""
    import casadi

    return {
        casadi.OP_ADD: lambda place, given, value: 1.0,
        casadi.OP_SUB: lambda place, given, value: 1.0 if place == 0 else -1.0,
        casadi.OP_NEG: lambda place, given, value: -1.0,
        casadi.OP_TWICE: lambda place, given, value: 2.0,
        casadi.OP_SQ: lambda place, given, value: given[0] + given[0],
        casadi.OP_MUL: lambda place, given, value: given[1 - place],
        casadi.OP_DIV: lambda place, given, value: (
            1.0 / given[1] if place == 0 else -value * (1.0 / given[1])
        ),
        casadi.OP_INV: lambda place, given, value: -(value * value),
        casadi.OP_FMIN: lambda place, given, value: _share(given[place], given[1 - place]),
        casadi.OP_FMAX: lambda place, given, value: _share(given[1 - place], given[place]),
        casadi.OP_SQRT: lambda place, given, value: 0.5 / value,
        casadi.OP_IF_ELSE_ZERO: lambda place, given, value: casadi.if_else(given[0], 1.0, 0.0),
    }


def _share(lesser: Any, larger: Any) -> Any:
    """Return one where the first is the lesser, half where both are equal, zero else."""
    return 0.5 * ((lesser <= larger) + (lesser < larger))


@cache
def _step_codes() -> frozenset[int]:
    import casadi

    return frozenset(getattr(casadi, name) for name in _STEPS)


@cache
def _template(code: int, place: int, count: int) -> Any:
    """Return the derivative of any other operation as a function of its operands."""
    import casadi

    symbols = [casadi.SX.sym(f"a{k}") for k in range(count)]
    make = casadi.SX.binary if count == 2 else casadi.SX.unary
    slope = casadi.jacobian(make(code, *symbols), symbols[place])
    return casadi.Function("slope", symbols, [casadi.densify(slope)])
