"""Fields of elements that are declared once: for Python, system files, their schema and reference.

An element is a frozen dataclass, registered as an "element_type", "sensor_type" or
"constraint_type". Its fields are declared by the functions below; from these system files get
their element of the same kind, in which numbers may be expressions of parameters.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import MISSING, field, fields, is_dataclass
from typing import Any, Literal

Nature = Literal["scalar", "polar", "axial", "sectional", "handed", "diagonal", "side"]
"""How a mirror image changes a value: not at all, as a place or force, as a torque, as a torque in
the axes of a section along a line, whose y axis alone turns round whatever the plane, as the
angle of a thread (its sign changes in every mirror), as three numbers along the axes (not at all),
as "left" and "right"."""

Variables = Literal["time", "motion"]
"""What a function depends on: the time, or also all coordinates and rates."""

ORIGIN = (0.0, 0.0, 0.0)


def number(
    unit: str,
    description: str,
    *,
    default: Any = MISSING,
    least: float | None = None,
    above: float | None = None,
    most: float | None = None,
    nature: Nature = "scalar",
    turns_with: tuple[str, ...] = (),
) -> Any:
    """Declare a number, which may be a symbol.

    Parameters
    ----------
    unit
        SI unit.
    description
        Meaning, one phrase.
    default
        Number where nothing is said; without it the field is required.
    least, above, most
        Bounds: not less than, greater than, not more than.
    nature
        How a mirror image changes it.
    turns_with
        Fields with names of coordinates: a mirror image that turns one of them round changes the
        sign of the number; or of a flag, whether it is set.
    """
    facts = {"least": least, "above": above, "most": most, "turns_with": turns_with or None}
    return _declared(default, "number", description, measure=unit, nature=nature, **facts)


def vector(unit: str, description: str, *, default: Any = MISSING, nature: Nature = "polar") -> Any:
    """Declare three numbers, which may be symbols, with the unit of each."""
    return _declared(default, "vector", description, measure=unit, nature=nature)


def function(
    unit: str,
    description: str,
    *,
    of: Variables,
    nature: Nature = "scalar",
    default: Any = MISSING,
    written: Any = 0.0,
) -> Any:
    """Declare a function of the time or of the situation, which system files write as expression.

    Parameters
    ----------
    unit
        SI unit of what it returns; "" is any.
    description
        Meaning, one phrase.
    of
        What it is a function of, and which names the expression may use: "time", or of the
        situation "motion" (time and all coordinates and rates).
    nature
        How a mirror image changes it; "polar" and "axial" functions return three numbers.
    default, written
        Function where nothing is said, and the expression that a file writes for it.
    """
    facts = {"measure": unit, "variables": of, "nature": nature}
    return _declared(default, "function", description, **facts, written=written)


def body_name(description: str, *, default: Any = MISSING, may_be_ground: bool = True) -> Any:
    """Declare the name of a body."""
    refused = None if may_be_ground else "the ground needs no force to stay; name another body"
    return _declared(default, "name", description, names="body", no_ground=refused)


def coordinate_name(description: str, *, default: Any = MISSING) -> Any:
    """Declare the name of a coordinate."""
    return _declared(default, "name", description, names="coordinate")


def constraint_name(description: str) -> Any:
    """Declare the name of a cut or constraint."""
    return _declared(MISSING, "name", description, names="constraint")


def file_name(description: str, *, default: Any = MISSING) -> Any:
    """Declare the name of a file, relative to the folder of the system file that names it."""
    return _declared(default, "file", description, is_file=True)


def attachment(description: str) -> Any:
    """Declare a point of a body, an :class:`Attachment`."""
    return _declared(MISSING, "attachment", description)


def choice(
    description: str, *, default: Any = MISSING, nature: Nature = "scalar", **facts: Any
) -> Any:
    """Declare a text, flag, or one or several of the values that a Literal annotation lists."""
    return _declared(default, "choice", description, nature=nature, **facts)


def law(family: str, description: str) -> Any:
    """Declare a law of two numbers, such as a force of length and rate.

    System files choose it from a catalogue, ``family``, with parameters of its own.
    """
    return _declared(MISSING, "law", description, family=family)


def group(description: str, *, default: Any = MISSING) -> Any:
    """Declare a field that holds a frozen dataclass of declared fields."""
    return _declared(default, "group", description)


def out_of_bounds(item: Any) -> Iterator[str]:
    """Yield what declared numbers of an element, and of groups in it, are beyond their bounds.

    Numbers that are symbols, or None, are not judged.
    """
    for known in fields(item) if is_dataclass(item) else ():
        facts, value = known.metadata, getattr(item, known.name, None)
        if facts.get("declared") == "group" and value is not None:
            yield from (f"{known.name}.{words}" for words in out_of_bounds(value))
        if facts.get("declared") != "number" or not isinstance(value, int | float):
            continue
        unit = "" if facts["measure"] in ("", "1") else f" {facts['measure']}"
        above, least, most = (facts.get(word) for word in ("above", "least", "most"))
        if math.isnan(value):
            yield f"{known.name}: is no number"
        elif above is not None and not value > above:
            yield f"{known.name}: must be greater than {above:g}{unit}, is {value:g}"
        elif least is not None and not value >= least:
            yield f"{known.name}: must be at least {least:g}{unit}, is {value:g}"
        elif most is not None and not value <= most:
            yield f"{known.name}: must be at most {most:g}{unit}, is {value:g}"


def _declared(default: Any, what: str, description: str, **facts: Any) -> Any:
    known = {name: value for name, value in facts.items() if value is not None}
    metadata = {"declared": what, "description": description, **known}
    return field(default=default, metadata=metadata)
