"""Angles within one turn."""

from __future__ import annotations

import math
from typing import Any

from vehicledyn.symbolic import ops

_TURN = 2.0 * math.pi


def wrapped(angle: Any) -> Any:
    """Return an angle from 0 to below 2 π, of a number or an expression [rad]."""
    if isinstance(angle, int | float):
        return float(angle) % _TURN
    return angle - _TURN * ops.floor(angle / _TURN)
