"""Names of profiles: standard ones, cones and circular arcs."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any, Literal

from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.base.slope_text import slope_of
from vehicledyn.base.units import to_si
from vehicledyn.base.yaml import copied, read_yaml

Kind = Literal["wheel", "rail"]

FOLDER = Path(__file__).parent
STANDARD = {"S1002": "s1002", "60E1": "60e1", "UIC60": "60e1", "60E1_manchester": "60e1_manchester"}
FORMULAS = ("cone:SLOPE", "arc:RADIUS")


def is_name(text: str) -> bool:
    """Return whether a text names a profile, rather than a file."""
    return _standard(text) is not None or text.partition(":")[0] in ("cone", "arc")


def check_name(text: str, kind: Kind) -> None:
    """Refuse a text that names no profile of a kind.

    Raises
    ------
    InputError
        If there is no such profile, or it is one of a rail where a wheel's is asked for.
    """
    if cone_slope(text) is None and arc_radius(text) is None:
        standard_data(text, kind)


def cone_slope(text: str) -> float | None:
    """Return the slope of a cone such as ``cone:1/40``, None of other names [1].

    Raises
    ------
    InputError
        If it is no slope.
    """
    formula, colon, value = text.partition(":")
    if not colon or formula != "cone":
        return None
    slope = slope_of(value)
    if slope is None or not 0.0 <= slope < 1.0:
        raise InputError(f"'{text}': write a slope from 0 to 1, such as cone:1/40")
    return slope


def arc_radius(text: str) -> float | None:
    """Return the radius of an arc such as ``arc:300 mm``, None of other names [m].

    Raises
    ------
    InputError
        If it is no radius.
    """
    formula, colon, value = text.partition(":")
    if not colon or formula != "arc":
        return None
    try:
        radius = to_si(f"{value} mm" if slope_of(value) is not None else value, "m")
    except InputError as error:
        raise InputError(f"'{text}': {error}") from None
    if not 1e-3 <= abs(radius) <= 1e3:
        raise InputError(f"'{text}': write a radius from 1 mm to 1000 m, such as 'arc:300 mm'")
    return radius


def standard_data(text: str, kind: Kind) -> dict[str, Any]:
    """Return the numbers of a standard profile, as the folder ``profiles`` holds them.

    Raises
    ------
    InputError
        If there is no such profile, or it is one of a rail where a wheel's is asked for.
    """
    stem = _standard(text)
    if stem is None:
        guess = nearest_name(text, STANDARD)
        hint = f"; did you mean '{guess}'?" if guess else "."
        known = ", ".join((*STANDARD, *FORMULAS))
        raise InputError(f"'{text}' is neither a file nor a profile{hint} Known profiles: {known}")
    data: dict[str, Any] = copied(_standard_file(stem))
    if data["kind"] != kind:
        raise InputError(f"'{text}' is the profile of a {data['kind']}, a {kind}'s is needed here")
    return data


@cache
def _standard_file(stem: str) -> dict[str, Any]:
    data: dict[str, Any] = read_yaml(FOLDER / f"{stem}.yaml").data
    return data


def _standard(text: str) -> str | None:
    wanted = text.lower()
    return next((stem for name, stem in STANDARD.items() if name.lower() == wanted), None)
