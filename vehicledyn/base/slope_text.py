"""Slopes as texts, as railways write them: 1:40, 1/20 or 0.025."""

from __future__ import annotations

import math
import re

_SHORT = 4
"""Digits of a ratio beyond which the slope itself is written."""

_RATIO = re.compile(r"\s*([+-]?\d+(?:\.\d*)?)\s*[:/]\s*(\d+(?:\.\d*)?)\s*")


def slope_of(text: str) -> float | None:
    """Return the slope that a text means, None if it means none.

    >>> slope_of("1:40"), slope_of("0.05"), slope_of("steep")
    (0.025, 0.05, None)
    """
    match = _RATIO.fullmatch(text)
    if match:
        rise, run = float(match[1]), float(match[2])
        value = rise / run if run > 0.0 else math.nan
        return value if math.isfinite(value) else None
    try:
        value = float(text)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def slope_text(angle: float) -> str:
    """Return the slope of an angle [rad] as railways write it, 1:20 where that is a short ratio.

    >>> slope_text(math.atan(0.05)), slope_text(math.atan(0.0437)), slope_text(0.0)
    ('1:20', '0.0437', '0')
    """
    slope = math.tan(angle)
    if slope == 0.0:
        return "0"
    ratio = f"{1.0 / abs(slope):.6g}"
    sign = "-" if slope < 0.0 else ""
    return f"{sign}1:{ratio}" if len(ratio.replace(".", "")) <= _SHORT else f"{slope:.6g}"
