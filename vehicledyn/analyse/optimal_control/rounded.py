"""Expressions with rounded corners: where the smaller or larger of two quantities takes over.

Dry friction that breaks away has corners, between which Newton's method goes to and fro. On the
way to an optimum they are rounded, by a part of what the two quantities are where they meet.
"""

from __future__ import annotations

from typing import Any


def rounded(expression: Any, inputs: list[Any], width: Any) -> Any:
    """Return an expression whose least and largest of two quantities are smooth.

    With a width w the larger of a and b becomes (a + b + ((a - b)² + w² s)^½) / 2 with
    s = 2 a² b² / (a² + b²), about the square of the one that is smaller in size; the smaller has a
    minus. Next to zero nothing is rounded: there is no size to measure by.

    Parameters
    ----------
    expression
        A column without calls.
    inputs
        The symbols in it.
    width
        The part w, above zero.
    """
    import casadi

    from vehicledyn.codegen.ir.sx_graph import Rebuild, read_nodes

    function = casadi.Function("rounded", inputs, [expression])
    nodes, results = read_nodes(function)
    rebuild, values = Rebuild(function, inputs, nodes), list[Any]()
    signs = {casadi.OP_FMAX: 1.0, casadi.OP_FMIN: -1.0}
    for node in nodes:
        code, operands, _ = node
        sign = signs.get(code)
        if sign is None or any(values[k].is_zero() for k in operands):
            values.append(rebuild.value(node, values))
            continue
        a, b = (values[k] for k in operands)
        size = 2.0 * a**2 * b**2 / (a**2 + b**2)
        apart = casadi.sqrt((a - b) ** 2 + width**2 * size)
        values.append(0.5 * (a + b + sign * apart))
    return rebuild.results(results, values)[0]


def has_least_or_most(expression: Any, inputs: list[Any]) -> bool:
    """Return whether a column asks for the smaller or the larger of two quantities."""
    import casadi

    function = casadi.Function("corners", inputs, [expression])
    codes = {function.instruction_id(k) for k in range(function.n_instructions())}
    return bool(codes & {casadi.OP_FMAX, casadi.OP_FMIN})
