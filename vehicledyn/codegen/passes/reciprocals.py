"""Divide once by what several quotients are divided by."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from typing import Any

from vehicledyn.codegen.ir.sx_graph import Rebuild, fixed_from, read_nodes


def use_reciprocals(
    function: Any, inputs: list[Any], is_fixed: Callable[[tuple[int, ...]], bool]
) -> list[Any]:
    """Return the results of a function with a / b replaced by a times 1/b where that pays.

    It pays where 1/b is used again, or depends on nothing but fixed inputs; ``is_fixed`` is asked
    for input and element. The results change by rounding.
    """
    import casadi

    nodes, results = read_nodes(function)
    dividing = {casadi.OP_DIV, casadi.OP_INV}
    divided = Counter(operands[-1] for code, operands, _ in nodes if code in dividing)
    fixed = fixed_from(nodes, is_fixed)
    rebuild = Rebuild(function, inputs, nodes)
    values: list[Any] = []
    inverse: dict[int, Any] = {}
    for node in nodes:
        code, operands, _ = node
        if code in dividing and (fixed[operands[-1]] or divided[operands[-1]] > 1):
            divisor = operands[-1]
            if divisor not in inverse:
                inverse[divisor] = casadi.SX.unary(casadi.OP_INV, values[divisor])
            numerator = casadi.SX(1.0) if code == casadi.OP_INV else values[operands[0]]
            is_one = numerator.is_constant() and float(numerator) == 1.0
            values.append(inverse[divisor] if is_one else numerator * inverse[divisor])
        else:
            values.append(rebuild.value(node, values))
    return rebuild.results(results, values)
