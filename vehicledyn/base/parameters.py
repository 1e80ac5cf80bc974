"""Parameter sets: each quantity is declared once with unit, meaning and bounds."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache
from typing import Any, ClassVar

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    ModelWrapValidatorHandler,
    ValidationError,
    ValidationInfo,
    field_validator,
    model_validator,
)

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.registry import find, kinds
from vehicledyn.base.units import describe, to_si
from vehicledyn.base.validation_messages import Complaint, complain, reword, words_of

Vector = tuple[float, float, float]


def quantity(
    unit: str,
    description: str,
    *,
    default: Any = ...,
    gt: float | None = None,
    ge: float | None = None,
    lt: float | None = None,
    le: float | None = None,
) -> Any:
    """Declare a quantity of a parameter set.

    Parameters
    ----------
    unit
        SI unit of the number inside the program, "1" for a pure number.
    description
        Meaning of the quantity, one phrase.
    default
        Only where physics or a convention gives one; without it the quantity is required.
    gt, ge, lt, le
        Bounds of the SI value. Do not use them with vectors.
    """
    return Field(
        default=default,
        description=description,
        json_schema_extra={"unit": unit},
        gt=gt,
        ge=ge,
        lt=lt,
        le=le,
    )


def part(family: str, description: str, *, default: Any = ...) -> Any:
    """Declare a field that holds one entry of a catalogue, chosen in the file by its ``kind``.

    Annotate the field with :class:`ParameterSet` (or a base class of the family), with a list
    of these, and with ``| None`` where it may be absent. The entry is looked up when a file is
    read, so families may grow at any time.

    Parameters
    ----------
    family
        Name of the catalogue, such as "driver".
    description
        What the part does, one phrase.
    default
        Value when the file says nothing; without it the part is required.
    """
    return Field(default=default, description=description, json_schema_extra={"family": family})


class ParameterSet(BaseModel):
    """Frozen set of parameters in SI units, read from values with units.

    Fields declared with :func:`quantity` accept a number (SI), a text with a unit, or for
    vectors a list of these; those declared with :func:`part` a mapping with ``kind``. Every
    other key than the declared ones is refused.
    """

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False, defer_build=True)

    family: ClassVar[str] = ""
    kind: ClassVar[str] = ""
    in_equations: ClassVar[bool] = False
    """Whether its quantities are numbers inside the equations, and no parameters of them."""

    @field_validator("*", mode="before")
    @classmethod
    def _read_field(cls, value: Any, info: ValidationInfo) -> Any:
        name = str(info.field_name)
        unit, family = field_unit(cls, name), field_family(cls, name)
        if value is None:
            return value
        if unit is not None:
            return _read_quantity(value, unit)
        if family is not None:
            return _read_parts(family, value)
        return value

    @model_validator(mode="wrap")
    @classmethod
    def _word_problems(cls, data: Any, handler: ModelWrapValidatorHandler[Any]) -> Any:
        try:
            return handler(data)
        except ValidationError as error:
            raise _reworded(error, cls) from None


def _read_quantity(value: Any, unit: str) -> Any:
    if isinstance(value, dict):
        raise ValueError(f"expected a number in {unit}, found {describe(value)}")
    if not isinstance(value, list | tuple):
        return _number(value, unit)
    numbers, complaints = [], []
    for index, item in enumerate(value):
        try:
            numbers.append(_number(item, unit))
        except ValueError as error:
            complaints.append(Complaint((index,), str(error), item))
    if complaints:
        raise complain("quantity", complaints)
    return tuple(numbers)


def _number(value: Any, unit: str) -> float:
    try:
        return to_si(value, unit)
    except InputError as error:
        raise ValueError(str(error)) from None


def _read_parts(family: str, value: Any) -> Any:
    if not isinstance(value, list | tuple):
        return read_part(family, value)
    parts, complaints = [], []
    for index, item in enumerate(value):
        try:
            parts.append(read_part(family, item))
        except ValidationError as error:
            complaints += [
                Complaint((index, *line["loc"]), words_of(line), item, line["type"])
                for line in error.errors()
            ]
    if complaints:
        raise complain(family, complaints)
    return parts


def read_part(family: str, value: Any) -> Any:
    """Return the entry of a catalogue that a mapping with ``kind`` describes.

    Parameters
    ----------
    family
        Name of the catalogue.
    value
        Mapping with ``kind`` and the entry's own fields, or with ``file`` alone where the
        catalogue has that kind; a finished set is returned as it is.

    Raises
    ------
    pydantic.ValidationError
        If the kind is missing or unknown, or a field of the entry is wrong.
    """
    if isinstance(value, ParameterSet):
        return value
    if not isinstance(value, dict):
        text = f"expected a mapping with 'kind', found {describe(value)}"
        raise complain(family, [Complaint((), text, value)])
    entry = _part_class(family, value)
    try:
        return entry.model_validate({key: item for key, item in value.items() if key != "kind"})
    except ValidationError as error:  # checks of the whole set are not yet in our words
        raise _reworded(error, entry) from None


def _reworded(error: ValidationError, entry: type[ParameterSet]) -> ValidationError:
    return reword(error, entry, {n: field_unit(entry, n) for n in entry.model_fields})


_FILE = "file"
"""Kind of a mapping that names a file and no kind, in catalogues that have it."""


def _part_class(family: str, value: dict[str, Any]) -> type[ParameterSet]:
    kind = value.get("kind", _FILE if _FILE in value and _FILE in kinds(family) else None)
    if kind in kinds(family):
        entry: type[ParameterSet] = find(family, str(kind))
        return entry
    text = unknown_name(family, str(kind), kinds(family))
    if kind is None:
        text = f"missing: the kind of {family}. Known: {', '.join(kinds(family)) or 'none'}"
    raise complain(family, [Complaint(("kind",), text, kind)])


def field_unit(parameters: type[ParameterSet], name: str) -> str | None:
    """Return the unit a field was declared with, or None if it is not a quantity."""
    return _declared(parameters, name, "unit")


def field_family(parameters: type[ParameterSet], name: str) -> str | None:
    """Return the catalogue a field takes its part from, or None if it is not a part."""
    return _declared(parameters, name, "family")


@lru_cache(maxsize=4096)
def _declared(parameters: type[ParameterSet], name: str, what: str) -> str | None:
    extra = parameters.model_fields[name].json_schema_extra
    return str(extra[what]) if isinstance(extra, dict) and what in extra else None


def as_plain(value: Any) -> Any:
    """Return a set as plain mappings, lists and SI numbers; parts begin with their ``kind``."""
    if isinstance(value, ParameterSet):
        head = {"kind": value.kind} if value.kind else {}
        return head | {name: as_plain(getattr(value, name)) for name in type(value).model_fields}
    if isinstance(value, dict):
        return {str(key): as_plain(item) for key, item in value.items()}
    return [as_plain(item) for item in value] if isinstance(value, list | tuple) else value


def units_of(value: Any, prefix: str = "") -> dict[str, str]:
    """Return the unit of every quantity of a set or list and its inner sets, by dotted name."""
    return dict(_units(value, prefix))


def _units(value: Any, prefix: str) -> Iterator[tuple[str, str]]:
    if isinstance(value, list | tuple):
        for index, item in enumerate(value):
            yield from _units(item, f"{prefix}{index}.")
    if not isinstance(value, ParameterSet):
        return
    for name in type(value).model_fields:
        unit, item = field_unit(type(value), name), getattr(value, name)
        if unit is not None:
            yield prefix + name, unit
        if isinstance(item, _NESTED):
            yield from _units(item, f"{prefix}{name}.")


_NESTED = (ParameterSet, list, tuple)
