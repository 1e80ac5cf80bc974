"""Tables in expressions: calls that find the cell of a place, and what they do to derivatives.

CasADi differentiates a call by calls of further functions. Those of a cell are zero everywhere,
since knot and coefficients do not change within a cell, so :func:`settled` removes them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from vehicledyn.symbolic.cell_functions import is_slope
from vehicledyn.symbolic.tables import CurveTable, any_called, table_of


def calls_in(function: Any) -> dict[int, Any]:
    """Return what a function made of SX expressions calls, by the number of the instruction."""
    import casadi

    if not function.get_function():
        return {}
    code_of, call = function.instruction_id, casadi.OP_CALL
    places = [k for k in range(function.n_instructions()) if code_of(k) == call]
    return calls_at(function, places)


def calls_at(function: Any, places: Sequence[int]) -> dict[int, Any]:
    """Return what a function calls, by the numbers of the instructions, which are calls."""
    if not places:
        return {}
    instructions = function.instructions_sx()
    return {k: instructions[k].which_function() for k in places}


def tables_in(expressions: Sequence[Any]) -> tuple[CurveTable, ...]:
    """Return the tables of SX matrices in the order in which they are first computed."""
    import casadi

    if not any_called():
        return ()
    results = [casadi.SX(item) for item in expressions]
    symbols = casadi.symvar(casadi.veccat(*results))
    tables: dict[str, CurveTable] = {}
    _collect(casadi.Function("tables", symbols, results), tables)
    return tuple(tables.values())


def _collect(function: Any, tables: dict[str, CurveTable]) -> None:
    """Add the tables that a function and those it calls look up."""
    for called in calls_in(function).values():
        table = table_of(called)
        if table is not None:
            tables.setdefault(called.name(), table)
        elif called.is_a("SXFunction"):
            _collect(called, tables)


def settled(expression: Any) -> Any:
    """Return an SX matrix without the derivatives of cells, which are zero."""
    if not any_called():
        return expression

    def without_slopes(function: Any, scalars: list[Any]) -> list[Any]:
        import casadi

        if is_slope(function.name()):
            return [casadi.SX(0.0)] * sum(function.nnz_out(k) for k in range(function.n_out()))
        return call_with(function, scalars)

    return walk_calls(expression, is_slope, without_slopes)


def walk_calls(
    expression: Any,
    concerned: Callable[[str], bool],
    replaced: Callable[[Any, list[Any]], list[Any]],
) -> Any:
    """Return an SX matrix with calls replaced; as it is where no called name is concerned.

    ``replaced`` returns the results of a call, given the function and its arguments as scalars.
    """
    import casadi

    symbols = casadi.symvar(expression)
    function = casadi.Function("walked", symbols, [expression])
    if not any(concerned(name) for name in function.get_function()):
        return expression
    return rewritten(function, [[symbol] for symbol in symbols], replaced)


def rewritten(
    function: Any,
    inputs: Sequence[Sequence[Any]],
    replaced: Callable[[Any, list[Any]], list[Any]],
) -> Any:
    """Return the first result of an SX function, built again from its instructions.

    ``inputs`` are scalars for the elements of its inputs; ``replaced`` returns the results of a
    call, see :func:`walk_calls`.
    """
    import casadi

    calls = calls_in(function)
    values: dict[int, Any] = {}
    entries = [casadi.SX(0.0)] * function.nnz_out(0)
    for k in range(function.n_instructions()):
        code = function.instruction_id(k)
        given, target = function.instruction_input(k), function.instruction_output(k)
        if code == casadi.OP_OUTPUT:
            entries[target[1]] = values[given[0]]
        elif code == casadi.OP_INPUT:
            values[target[0]] = inputs[given[0]][given[1]]
        elif code == casadi.OP_CONST:
            values[target[0]] = casadi.SX(function.instruction_constant(k))
        elif code == casadi.OP_CALL:
            found = replaced(calls[k], [values[item] for item in given])
            values.update((place, found[n]) for n, place in enumerate(target) if place >= 0)
        elif len(given) == 2:
            values[target[0]] = casadi.SX.binary(code, values[given[0]], values[given[1]])
        else:
            values[target[0]] = casadi.SX.unary(code, values[given[0]])
    return casadi.SX(function.sparsity_out(0), casadi.vertcat(*entries))


def call_with(function: Any, scalars: Sequence[Any]) -> list[Any]:
    """Return the results of a function one by one, given its arguments one by one."""
    import casadi

    arguments, first = [], 0
    for k in range(function.n_in()):
        size = function.nnz_in(k)
        column = casadi.vertcat(*scalars[first : first + size])
        arguments.append(casadi.SX(function.sparsity_in(k), column))
        first += size
    found = []
    for k, result in enumerate(function.call(arguments)):
        found += casadi.SX(function.sparsity_out(k), result).nonzeros()
    return found
