"""Numbers and key figures as readers of a page see them."""

from __future__ import annotations

import math
from datetime import UTC, datetime
from typing import Any

from vehicledyn.base.units import shown
from vehicledyn.results.plots.plot_style import axis_label


def number(value: float, digits: int = 4) -> str:
    """Return a number with some significant digits, a dash where there is none.

    Adding zero turns -0.0 into 0.0.

    >>> number(-0.0), number(1234567.0), number(math.nan)
    ('0', '1.235e+06', '–')
    """
    if math.isnan(value):
        return "–"
    return f"{value + 0.0:.{digits}g}"


def reading(value: Any, unit: str) -> str:
    """Return a value with its unit as a person reads it; truth values as yes and no."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float) and not math.isfinite(value):
        return "not a number"
    number_text, _, unit_shown = shown(value, unit).partition(" ")
    if isinstance(value, str):
        return value
    # Held together: lines of a page break between words.
    return f"{number_text}\u00a0{unit_text(unit_shown)}".rstrip()


def unit_text(unit: str) -> str:
    """Return a unit with raised exponents, nothing for plain numbers.

    >>> unit_text("m/s^2"), unit_text("1")
    ('m/s²', '')
    """
    return "" if unit in ("", "1") else axis_label("", unit)[2:-1]


def moment(text: str) -> str:
    """Return a time stamp as a person reads it, as it is if it is none.

    >>> moment("2026-11-20T15:39:47+00:00")
    '2026-11-20 15:39 UTC'
    """
    try:
        instant = datetime.fromisoformat(text)
    except ValueError:
        return text
    return f"{instant.astimezone(UTC):%Y-%m-%d %H:%M} UTC" if instant.tzinfo else text


def change(value: Any, other: Any, unit: str) -> str:
    """Return how far a value is from another, with the part of it in per cent."""
    if any(isinstance(each, str | bool | complex) for each in (value, other)):
        return "equal" if value == other else "different"
    difference = float(value) - float(other)
    if not math.isfinite(difference):
        return "–"
    if not difference:
        return "equal"
    share = f" ({100.0 * difference / abs(other):+.3g} %)" if other else ""
    text = reading(difference, unit)
    return f"{'' if text.startswith('-') else '+'}{text}{share}"
