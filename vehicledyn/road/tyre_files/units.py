"""Units of a tyre property file: what its section [UNITS] says, and the factors to SI."""

from __future__ import annotations

import math
import re

from vehicledyn.base.errors import unknown_name
from vehicledyn.base.problems import Mark, Problem
from vehicledyn.road.tyre_files.lines import Assignment

_POUND = 0.45359237
_POUND_FORCE = _POUND * 9.80665
_DEGREE = math.pi / 180.0

FACTORS: dict[str, dict[str, float]] = {
    "length": {
        **dict.fromkeys(("meter", "metre", "m"), 1.0),
        **dict.fromkeys(("mm", "millimeter"), 1e-3),
        **dict.fromkeys(("cm", "centimeter"), 1e-2),
        **dict.fromkeys(("km", "kilometer"), 1e3),
        **dict.fromkeys(("inch", "in"), 0.0254),
        **dict.fromkeys(("foot", "ft"), 0.3048),
        "mile": 1609.344,
    },
    "force": {
        **dict.fromkeys(("newton", "n"), 1.0),
        **dict.fromkeys(("knewton", "kn", "kilonewton"), 1e3),
        **dict.fromkeys(("pound_force", "lbf"), _POUND_FORCE),
        "kpound_force": 1e3 * _POUND_FORCE,
        "dyne": 1e-5,
        "ounce_force": _POUND_FORCE / 16.0,
        **dict.fromkeys(("kg_force", "kgf"), 9.80665),
    },
    "angle": {
        **dict.fromkeys(("radians", "radian", "rad"), 1.0),
        **dict.fromkeys(("degrees", "degree", "deg"), _DEGREE),
    },
    "mass": {
        **dict.fromkeys(("kg", "kilogram"), 1.0),
        **dict.fromkeys(("gram", "g"), 1e-3),
        **dict.fromkeys(("pound_mass", "lbm"), _POUND),
        "kpound_mass": 1e3 * _POUND,
        "slug": _POUND_FORCE / 0.3048,
        "ounce_mass": _POUND / 16.0,
    },
    "time": {
        **dict.fromkeys(("second", "sec", "s"), 1.0),
        **dict.fromkeys(("millisecond", "milli", "ms"), 1e-3),
        **dict.fromkeys(("minute", "min"), 60.0),
        "hour": 3600.0,
    },
    "pressure": {
        **dict.fromkeys(("pascal", "pa"), 1.0),
        **dict.fromkeys(("kpascal", "kpa"), 1e3),
        "bar": 1e5,
        "psi": _POUND_FORCE / 0.0254**2,
        "ksi": 1e3 * _POUND_FORCE / 0.0254**2,
    },
}
"""Factor to SI of each unit that a file may name, by dimension."""

_REQUIRED = ("length", "force", "angle", "mass", "time")
_NO_DIMENSION = "1"
_POWER = re.compile(r"([*/]?)(\w+)(?:\^(\d))?")


def read_units(entries: list[Assignment], source: str) -> tuple[dict[str, float], list[Problem]]:
    """Return the factor to SI of each dimension.

    Where a file has no unit of pressure it is force over length squared: pascals of newton and
    meter, N/mm² of newton and mm.
    """
    factors: dict[str, float] = {}
    problems = []
    lines = {e.name.lower(): e for e in entries if e.section == "UNITS"}
    for name, entry in lines.items():
        if name not in FACTORS:
            words = unknown_name("dimension", name, FACTORS)
        elif entry.text.lower() not in FACTORS[name]:
            words = unknown_name(f"unit of {name}", entry.text, FACTORS[name])
        else:
            factors[name] = FACTORS[name][entry.text.lower()]
            continue
        problems.append(Problem(source, Mark(entry.line, 1), f"[UNITS] {entry.name}", words))
    missing = [name.upper() for name in _REQUIRED if name not in lines]
    if missing:
        words = f"missing: {', '.join(missing)}; a file says its units there"
        problems.append(Problem(source, None, "[UNITS]", words))
    factors.setdefault("pressure", factors.get("force", 1.0) / factors.get("length", 1.0) ** 2)
    return {name: factors.get(name, 1.0) for name in FACTORS}, problems


def factor(dimension: str, factors: dict[str, float]) -> float:
    """Return the factor to SI of a product of dimensions such as "force*time/length".

    >>> factor("force/length^2", {"force": 1e3, "length": 1e-3})
    1000000000.0
    """
    if dimension == _NO_DIMENSION:
        return 1.0
    product = 1.0
    for sign, name, power in _POWER.findall(dimension):
        step = 1.0 if name == _NO_DIMENSION else factors[name] ** int(power or 1)
        product = product / step if sign == "/" else product * step
    return product
