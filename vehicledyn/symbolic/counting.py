"""Count the operations of expressions, to choose between two ways to the same result."""

from __future__ import annotations

from vehicledyn.symbolic.ops import Scalar


def count_operations(expression: Scalar) -> int:
    """Return the number of different operations of an SX matrix, its symbols not counted."""
    import casadi

    return int(casadi.n_nodes(expression)) - len(casadi.symvar(expression))
