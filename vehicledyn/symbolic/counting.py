"""Count the operations of expressions, to choose between two ways to the same result."""

from __future__ import annotations

from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.shared import inlined


def count_operations(expression: Scalar) -> int:
    """Return the number of different operations of an SX matrix, its symbols not counted.

    Those of shared functions count at each call.
    """
    import casadi

    written = inlined(expression)
    return int(casadi.n_nodes(written)) - len(casadi.symvar(written))
