"""Arithmetic of units: what an expression is measured in, found without its values."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from functools import cache, lru_cache
from typing import Any

from vehicledyn.base.units import missing_unit, parse_unit
from vehicledyn.files.expressions.algebra import Algebra, ExpressionError, WrittenNumber

Power = int | Fraction
Powers = tuple[Power, Power, Power, Power]

_COMMON = (
    "1", "m", "kg", "s", "rad", "m/s", "m/s^2", "rad/s", "rad/s^2", "N", "N/m", "N*s/m", "kg*m^2",
    "N*m", "N*m/rad", "N*m*s/rad", "Pa", "W", "1/s", "1/m", "m^2", "m^3", "kg/m", "kg/m^3",
    "N*s", "N*m*s", "N/m^2", "N/m^3", "rad/m", "m/rad", "kg*m",
)  # fmt: skip
_BASE = ("m", "kg", "s", "rad")


@dataclass(frozen=True)
class Measure:
    """Powers of metre, kilogram, second and radian.

    ``bare`` holds the value of a number written without unit: zero goes with everything, any
    other is a pure number. ``exact`` says that nothing was calculated,
    so that a frequency and an angular velocity are distinguished; elsewhere radians come and go.
    """

    powers: Powers
    bare: float | None = None
    exact: bool = False

    @property
    def lengths(self) -> tuple[Power, ...]:
        """Powers of all but the radian."""
        return self.powers[:3]

    @property
    def is_pure(self) -> bool:
        """Whether it is a number or an angle."""
        return not any(self.lengths)

    @property
    def unit(self) -> str:
        """SI unit, such as "N/m"."""
        common = _common_units().get(self.powers)
        if common is not None:
            return common
        above = [_power(n, p) for n, p in zip(_BASE, self.powers, strict=True) if p > 0]
        below = [_power(n, -p) for n, p in zip(_BASE, self.powers, strict=True) if p < 0]
        return "/".join(["*".join(above) or "1", *below])

    def fits(self, unit: str) -> bool:
        """Return whether a quantity in this unit is meant, zero always."""
        wanted = measure_of(unit)
        if self.bare is not None:
            return self.bare == 0.0 or not any(wanted.powers)
        m, kg, s = self.lengths
        is_rate = m == kg == 0 and s != 0
        if self.exact and is_rate:
            return self.powers == wanted.powers
        return self.lengths == wanted.lengths

    def replaces(self, other: Measure) -> bool:
        """Return whether a quantity can take the place of one measured so."""
        return self.fits(other.unit) or (not other.exact and self.lengths == other.lengths)


def misfit(measure: Measure, unit: str) -> str:
    """Return what to say of a quantity that does not fit where this unit is needed."""
    needed = "a pure number" if unit == "1" else f"a quantity in {unit}"
    if measure.bare is not None and measure.exact:
        return missing_unit(measure.bare, unit)
    if measure.is_pure and not any(measure.powers):
        return f"this is a pure number, {needed} is needed here; write numbers with their unit"
    return f"this is in {measure.unit}, {needed} is needed here"


@lru_cache(maxsize=256)
def measure_of(unit: str) -> Measure:
    """Return the measure of a unit."""
    return Measure(_powers(parse_unit(unit).dimension), exact=True)


@cache
def _common_units() -> dict[Powers, str]:
    """Return the first of the common units of each measure."""
    return {measure_of(name).powers: name for name in reversed(_COMMON)}


def multiplier_unit(zero: Measure, *, is_rate: bool) -> str:
    """Return the unit of the multiplier of a constraint: J a unit of what is zero, W of a rate."""
    work = measure_of("W" if is_rate else "J")
    m, kg, s, _ = (a - b for a, b in zip(work.powers, zero.powers, strict=True))
    unit = Measure((m, kg, s, 0)).unit
    return "N*m" if unit == "J" else unit


def _powers(dimension: Any) -> Powers:
    m, kg, s, rad = (p if isinstance(p, int) else _whole_or_part(Fraction(p)) for p in dimension)
    return (m, kg, s, rad)


def _whole_or_part(power: Fraction) -> Power:
    """Return a power as an integer where it is one, which computes more quickly."""
    return power.numerator if power.denominator == 1 else power


def _power(name: str, power: Power) -> str:
    return name if power == 1 else f"{name}^{power}"


def _number(quantity: WrittenNumber) -> Measure:
    if quantity.given is None:
        return Measure(_powers((0, 0, 0, 0)), bare=quantity.value, exact=True)
    return Measure(_powers(quantity.given.dimension), exact=True)


def _same(a: Measure, b: Measure) -> Measure:
    """Return the measure of a sum."""
    for number, other in ((a, b), (b, a)):
        if number.bare is not None and (number.bare == 0.0 or other.is_pure):
            return Measure(other.powers, other.bare, other.exact)
        if number.bare is not None and number.exact:
            raise ExpressionError(missing_unit(number.bare, other.unit))
    if a.lengths != b.lengths:
        raise ExpressionError(f"a quantity in {a.unit} and one in {b.unit} do not go together")
    return a if a.powers == b.powers else Measure(a.powers)


def _sum(a: Measure, b: Measure, sign: float) -> Measure:
    if a.bare is not None and b.bare is not None:
        return Measure(b.powers, a.bare + sign * b.bare)
    return _same(a, b)


def _times(a: Measure, b: Measure) -> Measure:
    return _product(a, b, 1)


def _over(a: Measure, b: Measure) -> Measure:
    return _product(a, b, -1)


def _product(a: Measure, b: Measure, sign: int) -> Measure:
    powers = _powers([p + sign * q for p, q in zip(a.powers, b.powers, strict=True)])
    if a.bare is None or b.bare is None:
        return Measure(powers)
    known = a.bare * b.bare if sign > 0 else a.bare / b.bare if b.bare else 0.0
    return Measure(powers, known)


def _raised(a: Measure, b: Measure) -> Measure:
    _need_pure(b, "an exponent")
    if a.is_pure:
        return Measure(_powers((0, 0, 0, 0)), _power_of_bare(a.bare, b.bare))
    if b.bare is None:
        raise ExpressionError(f"a quantity in {a.unit} can only be raised to a plain number")
    return _to_power(a, Fraction(b.bare).limit_denominator(12))


def _power_of_bare(base: float | None, exponent: float | None) -> float | None:
    """Return a power, or one where it is no number; the arithmetic of numbers complains then."""
    if base is None or exponent is None:
        return None
    try:
        found = base**exponent
    except (OverflowError, ZeroDivisionError):
        return 1.0
    return found if isinstance(found, float) and math.isfinite(found) else 1.0


def _to_power(a: Measure, power: Fraction) -> Measure:
    return Measure(_powers([p * power for p in a.powers]))


def _root(a: Measure) -> Measure:
    return a if a.bare is not None else _to_power(a, Fraction(1, 2))


def _negative(a: Measure) -> Measure:
    return Measure(a.powers, None if a.bare is None else -a.bare, a.exact)


def _need_pure(a: Measure, what: str) -> None:
    if not a.is_pure:
        raise ExpressionError(f"{what} must be a number or an angle, this one is in {a.unit}")


def _of_number(name: str) -> Callable[[Measure], Measure]:
    def function(a: Measure) -> Measure:
        _need_pure(a, f"the argument of {name}()")
        return Measure(_powers((0, 0, 0, 0)))

    return function


def _ratio(a: Measure, b: Measure) -> Measure:
    _same(a, b)
    return Measure(_powers((0, 0, 0, 0)))


MEASURES: Algebra = {
    "number": _number,
    "pi": lambda: Measure(_powers((0, 0, 0, 0))),
    "+": lambda a, b: _sum(a, b, 1.0),
    "-": lambda a, b: _sum(a, b, -1.0),
    "*": _times,
    "/": _over,
    "**": _raised,
    "negative": _negative,
    "sqrt": _root,
    "abs": lambda a: Measure(a.powers, a.bare),
    "min": _same,
    "max": _same,
    "sign": lambda _: Measure(_powers((0, 0, 0, 0))),
    "atan2": _ratio,
    **dict.fromkeys(("<", "<=", ">", ">="), _ratio),
    "where": lambda _, yes, no: _same(yes, no),
    **{
        name: _of_number(name)
        for name in ("sin", "cos", "tan", "asin", "acos", "atan", "tanh", "exp", "log")
    },
}
"""Arithmetic of measures."""
