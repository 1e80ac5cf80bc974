"""Sums of symbols with numbers as weights."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


def weighted_sum(
    weights: Sequence[float] | NDArray[np.float64], values: Sequence[Scalar]
) -> Scalar:
    """Return the sum of values times weights, without the terms whose weight is zero."""
    total = ops.scalar(0.0)
    for weight, value in zip(weights, values, strict=True):
        if weight:
            total = total + float(weight) * value
    return total
