"""Fields of the sets in system files: expressions with a measure, and names of other parts."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import Annotated, Any

from pydantic import (
    ConfigDict,
    Field,
    PlainValidator,
    ValidationError,
    WithJsonSchema,
    field_validator,
)
from pydantic_core.core_schema import ValidationInfo

from vehicledyn.base.parameters import ParameterSet, read_part
from vehicledyn.base.units import describe
from vehicledyn.base.validation_messages import UNKNOWN_KEY, Complaint, complain, words_of
from vehicledyn.files.expressions.expressions import Expression, named, read_expression

_ONE: dict[str, Any] = {"type": ["number", "string"]}
_THREE: dict[str, Any] = {"type": "array", "items": _ONE, "minItems": 3, "maxItems": 3}


def _read_list(value: Any) -> tuple[Expression, ...]:
    if not isinstance(value, list | tuple):
        raise ValueError(f"expected a list, found {describe(value)}")
    return tuple(map(read_expression, value))


def _read_moments(value: Any) -> tuple[Expression, ...]:
    if not isinstance(value, str):
        return _read_list(value)
    name = read_expression(value).root.name
    if not name:
        raise ValueError(f"expected a list or the name of a vector, found {describe(value)}")
    return tuple(named(f"{name}.{axis}") for axis in "xyz")


Scalar = Annotated[Expression, PlainValidator(read_expression), WithJsonSchema(_ONE)]
"""An expression worth one number."""

Vector = Annotated[
    Expression,
    PlainValidator(read_expression),
    WithJsonSchema({"anyOf": [_THREE, {"type": "string"}]}),
]
"""An expression worth three numbers, or a list of three expressions."""

Scalars = Annotated[
    tuple[Expression, ...],
    PlainValidator(_read_list),
    WithJsonSchema({"type": "array", "items": _ONE}),
]
"""A list of expressions, each worth one number."""


Moments = Annotated[
    tuple[Expression, ...],
    PlainValidator(_read_moments),
    WithJsonSchema({"anyOf": [{"type": "array", "items": _ONE}, {"type": "string"}]}),
]
"""Moments of inertia: a list of expressions, or the name of a vector of three."""


def measured(
    unit: str,
    description: str,
    *,
    default: Any = ...,
    nature: str = "scalar",
    least: float | None = None,
    above: float | None = None,
    most: float | None = None,
    variables: str = "",
) -> Any:
    """Declare a field that holds an expression.

    Parameters
    ----------
    unit
        SI unit of its value. In force and time laws ``{length}`` and ``{force}`` stand for the
        units of the coordinate they act on and of its force, in joints ``{inertia}`` for that of
        what the coordinate moves.
    description
        Meaning, one phrase.
    default
        Value when the file says nothing; without it the field is required.
    nature
        How a mirror image changes it: "scalar" (not at all), "polar" (a place or force),
        "axial" (a torque), "inertia" (six elements), "diagonal" (three numbers along the axes,
        not at all).
    least, above, most
        Bounds of the value: not less than, greater than, not more than.
    variables
        Names it may use besides parameters: "" none, "time", "law" (length and rate), "motion"
        (time and all coordinates and rates), "force" (these and position and rate).
    """
    extra = {"measure": unit, "nature": nature, "variables": variables}
    bounds = {"least": least, "above": above, "most": most}
    known = {name: value for name, value in bounds.items() if value is not None}
    return Field(default=default, description=description, json_schema_extra={**extra, **known})


def reference(what: str, description: str, *, default: Any = ...) -> Any:
    """Declare a field that names a "body" or "coordinate" of the system."""
    return Field(default=default, description=description, json_schema_extra={"names": what})


def section(family: str, description: str, *, kind: str = "") -> Any:
    """Declare a mapping from names to entries of a catalogue, all of one kind if that is given."""
    extra: Any = {"section": family, "section_kind": kind}
    return Field(default_factory=dict, description=description, json_schema_extra=extra)


class SystemSet(ParameterSet):
    """Base of the sets in system files; built when first used, which keeps the start quick."""

    model_config = ConfigDict(defer_build=True)

    @field_validator("*", mode="before")
    @classmethod
    def _read_sections(cls, value: Any, info: ValidationInfo) -> Any:
        family = fact(cls, str(info.field_name), "section")
        if family is None or not isinstance(value, dict):
            return value
        kind, entries, complaints = fact(cls, str(info.field_name), "section_kind"), {}, []
        for name, item in value.items():
            try:
                entries[name] = read_part(str(family), _of_kind(item, kind))
            except ValidationError as error:
                complaints += [
                    Complaint((name, *line["loc"]), words_of(line), item, line["type"])
                    for line in error.errors()
                ]
        if complaints:
            raise complain(str(family), complaints)
        return entries


def _of_kind(item: Any, kind: str) -> Any:
    """Return what a section holds with the kind that goes without saying."""
    if not kind or not isinstance(item, dict):
        return item
    if "kind" in item:
        words = f"unknown key; all entries of this section are of kind {kind}"
        raise complain("section", [Complaint(("kind",), words, item, UNKNOWN_KEY)])
    return {"kind": kind, **item}


@lru_cache(maxsize=4096)
def fact(parameters: type[ParameterSet], name: str, what: str) -> Any:
    """Return what a field was declared with, such as its "measure"; None if it was not."""
    extra = parameters.model_fields[name].json_schema_extra
    return extra.get(what) if isinstance(extra, dict) else None


def expressions(item: ParameterSet, name: str) -> Iterator[tuple[tuple[int, ...], Expression]]:
    """Yield the expressions of a field with their places inside it."""
    value = getattr(item, name)
    if isinstance(value, Expression):
        yield (), value
    elif isinstance(value, tuple):
        yield from (((k,), entry) for k, entry in enumerate(value) if isinstance(entry, Expression))


def read_mapping(value: Any) -> Any:
    """Return a mapping with its values read as expressions, all mistakes reported at once."""
    if not isinstance(value, dict):
        return {} if value is None else value
    read, complaints = {}, []
    for name, item in flattened(value).items():
        try:
            read[name] = read_expression(item)
        except ValueError as error:
            complaints.append(Complaint((name,), str(error), item))
    if complaints:
        raise complain("expressions", complaints)
    return read


def flattened(value: dict[str, Any], head: str = "") -> dict[str, Any]:
    """Return a nested mapping as one of dotted names."""
    flat: dict[str, Any] = {}
    for name, item in value.items():
        if isinstance(item, dict):
            flat |= flattened(item, f"{head}{name}.")
        else:
            flat[f"{head}{name}"] = item
    return flat
