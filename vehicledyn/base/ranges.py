"""Ranges of values as texts: ``-80 mm:80 mm:16`` is 17 values, ``20 mm`` is one."""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.base.errors import InputError
from vehicledyn.base.units import to_si

MOST_STEPS = 100_000


@dataclass(frozen=True)
class Range:
    """Evenly spaced values from ``first`` to ``last``, still as texts, in ``steps`` steps."""

    first: str
    last: str
    steps: int

    def values(self, unit: str) -> tuple[float, ...]:
        """Return the values in an SI unit.

        Raises
        ------
        InputError
            If a value is no quantity in this unit.
        """
        low, high = (_quantity(text, unit) for text in (self.first, self.last))
        if self.steps == 0:
            return (low,)
        return tuple(low + (high - low) * k / self.steps for k in range(self.steps + 1))


def read_range(text: str) -> Range:
    """Return the range that a text means: one value, or FROM:TO:STEPS.

    Raises
    ------
    InputError
        If it is neither, or the number of steps is not a whole positive one.
    """
    parts = [part.strip() for part in text.split(":")]
    if len(parts) == 1 and parts[0]:
        return Range(parts[0], parts[0], 0)
    if len(parts) != 3 or not all(parts):
        raise InputError(f"'{text}': write a value or FROM:TO:STEPS, such as -80 mm:80 mm:16")
    try:
        steps = int(parts[2])
    except ValueError:
        steps = 0
    if not 1 <= steps <= MOST_STEPS:
        raise InputError(f"'{text}': the number of steps is a whole number from 1 to {MOST_STEPS}")
    return Range(parts[0], parts[1], steps)


def _quantity(text: str, unit: str) -> float:
    value = to_si(text, unit)
    if not abs(value) < float("inf"):
        raise InputError(f"'{text}' is not finite")
    return value
