"""Cosine and sine of angles given as numbers, exact at whole quarter turns.

The double next to π/2 has the cosine 6.1e-17, not zero. In equations that residue keeps every
product alive that an exact zero removes, so angles within rounding of n π/2 give 0 or ±1.
"""

from __future__ import annotations

import math

_ROUNDING = 4.0 * 2.0**-52
"""Relative distance from a whole number of quarter turns that arithmetic on angles leaves."""


def cosine(angle: float) -> float:
    """Return the cosine of an angle [rad], exact at whole quarter turns."""
    quarters = _quarters(angle)
    return math.cos(angle) if quarters is None else (1.0, 0.0, -1.0, 0.0)[quarters % 4]


def sine(angle: float) -> float:
    """Return the sine of an angle [rad], exact at whole quarter turns."""
    quarters = _quarters(angle)
    return math.sin(angle) if quarters is None else (0.0, 1.0, 0.0, -1.0)[quarters % 4]


def _quarters(angle: float) -> int | None:
    """Return the number of quarter turns, not zero, that an angle is within rounding; or None."""
    if not math.isfinite(angle):
        return None
    turns = angle / (0.5 * math.pi)
    nearest = round(turns)
    if nearest == 0 or abs(turns - nearest) > _ROUNDING * abs(nearest):
        return None
    return nearest
