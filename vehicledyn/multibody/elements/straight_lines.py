"""Maps of elements: straight lines between points, constant beyond them."""

from __future__ import annotations

from collections.abc import Sequence

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


def straight_lines(x: Sequence[float], y: Sequence[float], at: Scalar) -> Scalar:
    """Return straight lines between points, constant beyond them.

    Parameters
    ----------
    x
        Arguments of the points, growing, at least two.
    y
        As many values.
    at
        The argument.
    """
    inside = ops.minimum(ops.maximum(at, x[0]), x[-1])
    slopes = [(y[k + 1] - y[k]) / (x[k + 1] - x[k]) for k in range(len(x) - 1)]
    total = y[0] + slopes[0] * (inside - x[0])
    for k in range(1, len(slopes)):
        if slopes[k] != slopes[k - 1]:
            total = total + (slopes[k] - slopes[k - 1]) * ops.maximum(inside - x[k], 0.0)
    return total
