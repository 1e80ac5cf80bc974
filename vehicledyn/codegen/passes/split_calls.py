"""Split a shared function into what is made of some of its arguments alone, and the rest.

A wheel's or joint's function is given parameters and states. What it makes of the parameters
alone need not be made again at each call.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from vehicledyn.base.bounded_cache import BoundedCache
from vehicledyn.codegen.ir.sx_graph import Rebuild, fixed_from, read_nodes
from vehicledyn.codegen.passes.reciprocals import use_reciprocals
from vehicledyn.symbolic.shared import known_function
from vehicledyn.symbolic.table_calls import call_with


@dataclass(frozen=True)
class _Split:
    """Two functions in place of one.

    ``early`` maps the fixed arguments to values; ``late`` maps the arguments ``used`` and these
    values to all results.
    """

    early: Any
    used: list[int]
    late: Any


_SPLITS: BoundedCache[tuple[str, tuple[bool, ...]], _Split | None] = BoundedCache(1024)


def call_apart(function: Any, fixed: tuple[bool, ...], arguments: Sequence[Any]) -> list[Any]:
    """Return the results of a call, with what is made of fixed arguments written out.

    Parameters
    ----------
    function
        A ``casadi.Function`` made of SX, of one column that returns one.
    fixed
        Which of the arguments are fixed.
    arguments
        The arguments of the call, scalars.
    """
    split = _SPLITS.get((function.name(), fixed), lambda: _split(function, fixed))
    if split is None:
        return call_with(function, arguments)
    known = [item for item, is_fixed in zip(arguments, fixed, strict=True) if is_fixed]
    values = call_with(split.early, known)
    return call_with(split.late, [*(arguments[k] for k in split.used), *values])


def _split(function: Any, fixed: tuple[bool, ...]) -> _Split | None:
    """Return a function split, None where it is not of one column."""
    import casadi

    if function.n_in() != 1 or function.n_out() != 1:
        return None
    symbols = casadi.SX.sym("a", len(fixed))
    name = function.name().split("_", 2)[-1]
    written = use_reciprocals(function, [symbols], lambda source: fixed[source[1]])
    function = casadi.Function(name, [symbols], written)
    nodes, results = read_nodes(function)
    early = fixed_from(nodes, lambda source: fixed[source[1]])
    plain = [code in (casadi.OP_INPUT, casadi.OP_CONST) for code, _, _ in nodes]
    needed = {value for _, value in results[0]}
    for (code, operands, _), is_early in zip(nodes, early, strict=True):
        if not is_early and code != casadi.OP_INPUT:
            needed.update(operands)
    wanted = sorted(k for k in needed if early[k] and not plain[k])
    used = sorted({nodes[k][1][1] for k in needed if nodes[k][0] == casadi.OP_INPUT})
    values = casadi.SX.sym("v", len(wanted))
    rebuild = Rebuild(function, [symbols], nodes)
    names = {value: values[k] for k, value in enumerate(wanted)}
    first: list[Any] = []
    late: list[Any] = []
    for k, node in enumerate(nodes):
        first.append(rebuild.value(node, first) if early[k] else None)
        is_late = plain[k] or not early[k]
        late.append(rebuild.value(node, late) if is_late else names.get(k))
    given = casadi.vertcat(*[symbols[k] for k, is_fixed in enumerate(fixed) if is_fixed])
    before = casadi.Function("early", [given], [casadi.vertcat(*[first[k] for k in wanted])])
    rest = casadi.vertcat(*[symbols[k] for k in used], values)
    return _Split(before, used, known_function(name, rest, rebuild.results(results, late)[0]))
