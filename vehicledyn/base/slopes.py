"""Slopes as texts, as railways write them: 1:40, 1/20 or 0.025."""

from __future__ import annotations

import math
import re

_RATIO = re.compile(r"\s*([+-]?\d+(?:\.\d*)?)\s*[:/]\s*(\d+(?:\.\d*)?)\s*")


def slope_of(text: str) -> float | None:
    """Return the slope that a text means, None if it means none.

    >>> slope_of("1:40"), slope_of("0.05"), slope_of("steep")
    (0.025, 0.05, None)
    """
    match = _RATIO.fullmatch(text)
    if match:
        return float(match[1]) / float(match[2]) if float(match[2]) > 0.0 else None
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None
