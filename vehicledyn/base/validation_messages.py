"""Words for what is wrong with a parameter set: a field's place and a message a user can act on."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError

from vehicledyn.base.errors import nearest_name
from vehicledyn.base.units import describe

Place = tuple[str | int, ...]
UNKNOWN_KEY = "unknown_key"
_WORDED = "worded"
_BOUNDS = {
    "greater_than": ("gt", "greater than"),
    "greater_than_equal": ("ge", "at least"),
    "less_than": ("lt", "less than"),
    "less_than_equal": ("le", "at most"),
}
_TYPES = {
    "string_type": "a text",
    "bool_type": "true or false",
    "bool_parsing": "true or false",
    "int_type": "a whole number",
    "int_parsing": "a whole number",
    "int_from_float": "a whole number",
    "float_type": "a number",
    "float_parsing": "a number",
    "list_type": "a list",
    "tuple_type": "a list",
    "dict_type": "a mapping",
    "model_type": "a mapping",
    "model_attributes_type": "a mapping",
    "finite_number": "a finite number",
}


class Complaint(NamedTuple):
    """Where in a set something is wrong, what, and the value that was given.

    ``code`` is "unknown_key" if the key itself is wrong, not its value.
    """

    place: Place
    message: str
    given: Any
    code: str = _WORDED


def complain(title: str, complaints: Sequence[Complaint]) -> ValidationError:
    """Return the validation error that holds these complaints word for word."""
    lines = [
        InitErrorDetails(
            type=PydanticCustomError(
                UNKNOWN_KEY if complaint.code == UNKNOWN_KEY else _WORDED,
                "{text}",
                {"text": complaint.message},
            ),
            loc=complaint.place,
            input=complaint.given,
        )
        for complaint in complaints
    ]
    return ValidationError.from_exception_data(title, lines)


def reword(
    error: ValidationError, parameters: type[BaseModel], units: Mapping[str, str | None]
) -> ValidationError:
    """Return the error of a set in our words, with the nearest name for an unknown key.

    Parameters
    ----------
    error
        What pydantic found, at any depth; complaints of inner sets are already in our words.
    parameters
        The set's class.
    units
        Unit of each of its fields, None for those that are no quantity.
    """
    complaints: dict[tuple[Place, str], Complaint] = {}
    lines = error.errors()
    lengths = {
        line["loc"][0]: int(line["loc"][-1]) + 1
        for line in lines
        if line["type"] == "missing" and len(line["loc"]) > 1
    }
    for line in lines:
        length = lengths.get(line["loc"][0]) if line["loc"] else None
        complaint = _complaint(line, parameters, units, length)
        complaints.setdefault((complaint.place, complaint.message), complaint)
    return complain(parameters.__name__, list(complaints.values()))


def words_of(line: ErrorDetails) -> str:
    """Return the message of an error; that of a validator without what pydantic puts in front."""
    return str(line["ctx"]["error"]) if line["type"] == "value_error" else line["msg"]


def _complaint(
    line: ErrorDetails,
    parameters: type[BaseModel],
    units: Mapping[str, str | None],
    length: int | None,
) -> Complaint:
    place, kind = line["loc"], line["type"]
    name = str(place[0]) if place else ""
    if kind in (_WORDED, UNKNOWN_KEY):
        return Complaint(place, line["msg"], line["input"], kind)
    if kind == "extra_forbidden":
        words = _unknown_key(name, list(parameters.model_fields))
        return Complaint(place, words, line["input"], UNKNOWN_KEY)
    if kind == "missing" and len(place) == 1:
        return Complaint(place, _missing(name, parameters, units.get(name)), line["input"])
    if kind in ("missing", "too_long"):
        return Complaint(place[:1], _wrong_length(line, length), line["input"])
    return Complaint(place, _wrong_value(line, units.get(name)), line["input"])


def _unknown_key(name: str, known: list[str]) -> str:
    guess = nearest_name(name, known)
    if guess:
        return f"unknown key; did you mean '{guess}'?"
    return f"unknown key. Known: {', '.join(known) or 'none'}"


def _missing(name: str, parameters: type[BaseModel], unit: str | None) -> str:
    meaning = parameters.model_fields[name].description
    measure = f"in {unit}" if unit and unit != "1" else None
    words = ", ".join(filter(None, (meaning, measure)))
    return f"missing: {words}" if words else "missing"


def _wrong_length(line: ErrorDetails, length: int | None) -> str:
    context, given = line.get("ctx", {}), line["input"]
    count = len(given) if isinstance(given, list | tuple) else context.get("actual_length")
    return f"expected {length or context['max_length']} values, found {count}"


def _wrong_value(line: ErrorDetails, unit: str | None) -> str:
    kind, context, given = line["type"], line.get("ctx", {}), line["input"]
    if kind in _BOUNDS:
        key, words = _BOUNDS[kind]
        suffix = f" {unit}" if unit and unit != "1" else ""
        return f"must be {words} {context[key]:g}{suffix}, is {given}"
    if kind in _TYPES:
        return f"expected {_TYPES[kind]}, found {_shown(given)}"
    if kind == "literal_error":
        guess = nearest_name(str(given), re.findall("'([^']*)'", str(context["expected"])))
        hint = f"; did you mean '{guess}'?" if guess else ""
        return f"must be {context['expected']}, is {_shown(given)}{hint}"
    return words_of(line)


def _shown(given: Any) -> str:
    return str(given).lower() if isinstance(given, bool) else describe(given)


def lower_first(text: str) -> str:
    """Return a phrase as it stands inside a sentence: "Yaw angle" becomes "yaw angle"."""
    return text[:1].lower() + text[1:] if text[1:2].islower() else text
