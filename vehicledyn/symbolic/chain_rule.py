"""Jacobians of expressions that call shared functions, whose derivatives are called with them.

CasADi differentiates a call with all results by all arguments, once more for each direction. Here
each place gets one call of a function that gives the results in use and their derivatives
together; the chain rule does the rest on sparse matrices.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.shared import body_of, is_shared, known_function
from vehicledyn.symbolic.table_calls import call_with, walk_calls

_Indices = tuple[int, ...]


@dataclass(frozen=True)
class _Place:
    """A call: its function, arguments, and symbols that stand for its results."""

    function: Any
    arguments: Any
    results: Any


def values_and_jacobian(expression: Any, variables: Any) -> tuple[Any, Any]:
    """Return a column and its Jacobian by a column of symbols, sparse, sharing their calls.

    Parameters
    ----------
    expression
        Column of functions, shape (n_values,).
    variables
        Symbols, shape (n_variables,).
    """
    import casadi

    places: list[_Place] = []

    def replaced(function: Any, scalars: list[Any]) -> list[Any]:
        if not is_shared(function.name()):
            return call_with(function, scalars)
        symbols = ops.symbols("called", function.numel_out(0))
        places.append(_Place(function, casadi.vertcat(*scalars), symbols))
        return [symbols[k] for k in range(symbols.numel())]

    outer = walk_calls(expression, is_shared, replaced)
    total = ops.jacobian(outer, variables)
    wanted = [outer, *[place.arguments for place in places]]
    made: dict[tuple[str, _Indices, _Indices], tuple[Any, Any]] = {}
    carried: list[tuple[Any, Any]] = []
    found: list[tuple[Any, Any]] = []
    for number, place in enumerate(places):
        later = casadi.vertcat(outer, *wanted[number + 2 :])
        flags = casadi.which_depends(later, place.results, 1, False)
        used = tuple(k for k, flag in enumerate(flags) if flag)
        inner = _chained(place.arguments, variables, carried)
        moving = tuple(sorted(set(inner.sparsity().row())))
        key = place.function.name(), used, moving
        if key not in made:
            made[key] = _with_slopes(place.function, used, moving)
        function, pattern = made[key]
        slopes = ops.symbols("slopes", pattern.nnz())
        inner = inner[list(moving), :]
        results = place.results[list(used)]
        carried.append((results, casadi.mtimes(casadi.SX(pattern, slopes), inner)))
        found.append((casadi.vertcat(results, slopes), function(place.arguments)))
        total += casadi.mtimes(ops.jacobian(outer, results), carried[-1][1])
    for symbols, values in reversed(found):
        outer, entries = casadi.substitute([outer, entries_of(total)], [symbols], [values])
        total = casadi.SX(total.sparsity(), entries)
    return outer, total


def _chained(arguments: Any, variables: Any, carried: list[tuple[Any, Any]]) -> Any:
    """Return the derivatives of arguments, which may be results of earlier calls."""
    import casadi

    total = ops.jacobian(arguments, variables)
    for results, slopes in carried:
        total += casadi.mtimes(ops.jacobian(arguments, results), slopes)
    return total


def _with_slopes(function: Any, used: _Indices, moving: _Indices) -> tuple[Any, Any]:
    """Return the function of results in use and their derivatives by arguments that move.

    The second is the pattern of the derivatives.
    """
    import casadi

    arguments = ops.symbols("argument", function.numel_in(0))
    results = body_of(function)(arguments)[list(used)]
    slopes = ops.jacobian(results, arguments[list(moving)])
    whole = casadi.cse(casadi.vertcat(results, entries_of(slopes)))
    return known_function("slopes", arguments, whole), slopes.sparsity()


def entries_of(matrix: Any) -> Any:
    """Return the structural nonzeros of a matrix as a column, column by column."""
    import casadi

    entries = matrix.nz[:]
    return casadi.reshape(entries, entries.numel(), 1)
