"""Units at the file's edge: text such as "36 km/h" becomes an SI number or is refused."""

from __future__ import annotations

import math
import re
from functools import lru_cache
from numbers import Real
from typing import NamedTuple

from vehicledyn.base.errors import InputError, nearest_name


class Unit(NamedTuple):
    """Factor to SI and the exponents of metre, kilogram, second and radian."""

    factor: float
    dimension: tuple[float, float, float, float]


_NONE = (0, 0, 0, 0)
_LENGTH = (1, 0, 0, 0)
_MASS = (0, 1, 0, 0)
_TIME = (0, 0, 1, 0)
_ANGLE = (0, 0, 0, 1)
_FORCE = (1, 1, -2, 0)

_PREFIXES = {"": 1.0, "G": 1e9, "M": 1e6, "k": 1e3, "c": 1e-2, "m": 1e-3, "µ": 1e-6, "u": 1e-6}
_PREFIXABLE = {
    "m": Unit(1.0, _LENGTH),
    "g": Unit(1e-3, _MASS),
    "s": Unit(1.0, _TIME),
    "rad": Unit(1.0, _ANGLE),
    "N": Unit(1.0, _FORCE),
    "Pa": Unit(1.0, (-1, 1, -2, 0)),
    "J": Unit(1.0, (2, 1, -2, 0)),
    "W": Unit(1.0, (2, 1, -3, 0)),
    "Hz": Unit(1.0, (0, 0, -1, 0)),
}
_PLAIN = {
    "1": Unit(1.0, _NONE),
    "%": Unit(0.01, _NONE),
    "permil": Unit(1e-3, _NONE),
    "deg": Unit(math.pi / 180.0, _ANGLE),
    "°": Unit(math.pi / 180.0, _ANGLE),
    "rev": Unit(2.0 * math.pi, _ANGLE),
    "rpm": Unit(2.0 * math.pi / 60.0, (0, 0, -1, 1)),
    "min": Unit(60.0, _TIME),
    "h": Unit(3600.0, _TIME),
    "t": Unit(1000.0, _MASS),
    "bar": Unit(1e5, (-1, 1, -2, 0)),
}
UNITS: dict[str, Unit] = {
    **{
        prefix + name: Unit(scale * unit.factor, unit.dimension)
        for name, unit in _PREFIXABLE.items()
        for prefix, scale in _PREFIXES.items()
    },
    **_PLAIN,
}
_SUPERSCRIPTS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")
_NUMBER = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*)", re.DOTALL | re.ASCII)
LONGEST = 1000
"""Characters of the longest text that is read as a quantity or unit."""
_FACTOR = re.compile(
    r"\s*(\*\*|[*/·]?)\s*([A-Za-zµ°%]+|1)"
    r"(?:\s*(?:\^|\*\*)?\s*([+-]?\d+)((?<=\^\d)\.\d{1,2})?)?\s*"
)


@lru_cache(maxsize=2048)
def parse_unit(text: str) -> Unit:
    """Return the unit that a text such as "N s/m", "kg*m^2" or "km/h" names.

    Raises
    ------
    InputError
        If a name in the text is not a known unit.
    """
    if len(text) > LONGEST:
        raise InputError(f"a text of {len(text)} characters is not a unit")
    superscripts = re.sub(r"([⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)", lambda m: "^" + m[1].translate(_SUPERSCRIPTS), text)
    rest = superscripts.replace("(", " ").replace(")", " ").strip() or "1"
    grouped = "(" in superscripts
    factor, seen_slash = 1.0, False
    dimension: list[float] = [0, 0, 0, 0]
    while rest:
        match = _FACTOR.match(rest)
        if match is None or match[1] == "**":
            raise InputError(f"'{text}' is not a unit")
        operator, name, exponent, part = match.groups()
        if name not in UNITS:
            guess = nearest_name(name, UNITS)
            hint = f"; did you mean '{guess}'?" if guess else ""
            raise InputError(f"'{name}' is not a known unit{hint}")
        seen_slash = seen_slash or operator == "/"
        inverse = operator == "/" or (grouped and seen_slash)
        if len((exponent or "").lstrip("+-0")) > 1:
            raise InputError(f"'{text}' is not a unit: the exponent {exponent} is too large")
        size = int(exponent or 1) if part is None else float(exponent + part)
        power = -size if inverse else size
        factor *= UNITS[name].factor ** power
        dimension = [d + power * e for d, e in zip(dimension, UNITS[name].dimension, strict=True)]
        rest = rest[match.end() :]
    return Unit(factor, (dimension[0], dimension[1], dimension[2], dimension[3]))


def to_si(value: object, unit: str) -> float:
    """Return a value given at the file's edge as an SI number.

    Parameters
    ----------
    value
        A number (taken as SI) or a text with a unit, such as "36 km/h"; zero and pure numbers
        need none.
    unit
        The SI unit the quantity has, such as "m/s".

    Raises
    ------
    InputError
        If the value is no number, or its unit is missing or has another dimension than ``unit``.
    """
    if isinstance(value, bool):
        raise InputError(f"expected a number in {unit}, found {str(value).lower()}")
    if isinstance(value, Real):
        try:
            return float(value)
        except OverflowError:
            raise InputError("the number is too large") from None
    if not isinstance(value, str):
        raise InputError(f"expected a number with a unit of {unit}, found {describe(value)}")
    if len(value) > LONGEST:
        raise InputError(
            f"expected a number with a unit of {unit}, found a text of {len(value)} characters"
        )
    match = _NUMBER.match(value.strip())
    if match is None:
        raise InputError(f"expected a number with a unit of {unit}, found '{value}'")
    number, unit_text = match.groups()
    given = parse_unit(unit_text)
    wanted = parse_unit(unit)
    if not unit_text:
        if is_bare(value) and not is_pure(unit):
            raise InputError(missing_unit(value, unit))
        return float(number)
    if given.dimension != wanted.dimension:
        raise InputError(f"'{value}' has the wrong unit: a quantity in {unit} is needed here")
    return float(number) * given.factor / wanted.factor


def with_unit(value: object, unit: str) -> float:
    """Return a value in SI as :func:`to_si`, that of a file, where numbers but zero need a unit.

    Raises
    ------
    InputError
        As there, and if it is a number without the unit that it needs.
    """
    if is_bare(value) and not is_pure(unit):
        raise InputError(missing_unit(value, unit))
    return to_si(value, unit)


def is_bare(value: object) -> bool:
    """Return whether a value is a number without a unit; zero is the same in all of them.

    So is what is infinite, and what is no number.
    """
    if isinstance(value, str):
        match = _NUMBER.match(value.strip()) if len(value) <= LONGEST else None
        return match is not None and not match[2] and float(match[1]) != 0.0
    if not isinstance(value, int | float) or isinstance(value, bool):
        return False
    return value != 0 and (isinstance(value, int) or math.isfinite(value))


_OFTEN = {"m/s": "km/h", "rad": "deg", "rad/s": "deg/s"}
"""Units that people often think of in place of SI units."""


def missing_unit(value: object, unit: str) -> str:
    """Return what to say of a number that lacks its unit.

    >>> missing_unit(72, "m/s")
    "72 has no unit; write '72 m/s' or '72 km/h'"
    """
    number = value.strip() if isinstance(value, str) else _shown_number(value)
    other = f" or '{number} {_OFTEN[unit]}'" if unit in _OFTEN else ""
    return f"{number} has no unit; write '{number} {unit}'{other}"


def _shown_number(value: object) -> str:
    try:
        return f"{value:.12g}"
    except OverflowError:
        return str(value)


def is_pure(unit: str) -> bool:
    """Return whether a unit has no dimension, as that of pure numbers."""
    return parse_unit(unit).dimension == _NONE


def describe(value: object) -> str:
    """Return what a value read from a file is, in words a user knows."""
    if value is None:
        return "nothing"
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, list | tuple):
        return "a list"
    return f"'{value}'"


_SHOWN_AS = {
    "rad": "deg",
    "rad/s": "deg/s",
    "1": "",
}


_MOST_DIGITS = 12


def digits_of(value: float, width: float) -> int:
    """Return the significant digits that show a value whose interval has a width, four or more.

    >>> digits_of(25000.0, 1.5)
    6
    """
    if not (value and width > 0.0 and math.isfinite(width) and math.isfinite(value)):
        return 4
    return min(max(4, math.ceil(math.log10(abs(value) / width)) + 1), _MOST_DIGITS)


def shown(value: float | int | bool | str, unit: str, digits: int = 4) -> str:
    """Return a value in SI as a person reads it: angles in degrees, some significant digits.

    >>> shown(0.05, "rad")
    '2.865 deg'
    """
    if isinstance(value, bool | str):
        return str(value)
    wanted = _SHOWN_AS.get(unit, unit)
    factor = parse_unit(unit).factor / parse_unit(wanted or "1").factor if unit else 1.0
    number = str(value) if isinstance(value, int) else f"{value * factor:.{digits}g}"
    return f"{number} {wanted}".rstrip()
