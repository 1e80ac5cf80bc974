"""Floors that keep a divisor away from zero and change nothing above a threshold."""

from __future__ import annotations

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

BLEND = 0.25
"""Half width of the rounded corner of :func:`floored`, as a part of the floor [1]."""


def floored(value: Scalar, floor: Scalar) -> Scalar:
    """Return ``value``, but never less than ``floor``, with continuous slope.

    With w = BLEND · floor the result is the floor below floor - w, the value itself (bit
    for bit) above floor + w, and the parabola floor + (value - floor + w)² / (4 w) between.

    Parameters
    ----------
    value, floor
        Quantities of the same unit; the floor is positive.
    """
    half_width = BLEND * floor
    over = ops.maximum(value - (floor - half_width), 0.0)
    rounded = floor + over * over * (0.25 / half_width)
    return ops.where(value > floor + half_width, value, rounded)
