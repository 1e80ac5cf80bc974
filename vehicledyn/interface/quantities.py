"""Quantities that Python gives as numbers in SI or texts with units."""

from __future__ import annotations

from collections.abc import Iterable
from math import isfinite

from vehicledyn.base.argument_names import given
from vehicledyn.base.errors import InputError
from vehicledyn.base.units import shown, to_si


def quantity(name: str, value: float | str, unit: str) -> float:
    """Return the value of an argument in SI.

    Raises
    ------
    InputError
        If it is no finite quantity of this unit; the message names the argument.
    """
    try:
        is_one = getattr(value, "size", 1) == 1
        number = to_si(value.item() if is_one and hasattr(value, "item") else value, unit)
    except InputError as error:
        raise InputError(f"{given(name, value)}: {error}") from None
    if not isfinite(number):
        raise InputError(f"{given(name, value)}: must be finite")
    if abs(number) > _LARGEST:
        raise InputError(f"{given(name, value)}: must be below {shown(_LARGEST, unit)}")
    return number


_LARGEST = 1e100
"""Numbers above it have squares and products that are infinite."""


def positive(name: str, value: float | str, unit: str) -> float:
    """Return the value of an argument in SI, which must be above zero."""
    number = quantity(name, value, unit)
    if number <= 0.0:
        raise InputError(f"{given(name, value)}: must be above zero")
    return number


def speed_in_si(value: float | str) -> float:
    """Return a speed, which must not be negative [m/s]."""
    number = quantity("speed", value, "m/s")
    if number < 0.0:
        raise InputError(f"{given('speed', value)}: must not be negative")
    return number


def speeds_in_si(value: float | str | Iterable[float | str] | None) -> list[float]:
    """Return one speed or several, none for None [m/s]."""
    if value is None:
        return []
    if isinstance(value, str) or not isinstance(value, Iterable):
        return [speed_in_si(value)]
    return [speed_in_si(item) for item in value]


def texts(name: str, value: str | Iterable[str], *, at_least: int = 1) -> list[str]:
    """Return one name or several as a list.

    Raises
    ------
    InputError
        If there are fewer than asked, or others than texts.
    """
    found = [value] if isinstance(value, str) else list(value)
    if len(found) < at_least or not all(isinstance(item, str) for item in found):
        raise InputError(f"{given(name, value)}: give one name or more")
    return found
