"""Sets of system files for elements of the catalogue, made from the fields that these declare."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import MISSING, Field, fields, is_dataclass
from functools import cache, partial
from pathlib import Path
from typing import Any, ClassVar, get_type_hints

from pydantic import Field as SetField
from pydantic import create_model, field_validator
from pydantic_core.core_schema import ValidationInfo

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import announce, find, kinds
from vehicledyn.files.expressions.expressions import Expression, read_expression
from vehicledyn.files.expressions.fields import Scalar, SystemSet, Vector, fact
from vehicledyn.files.system.laws import ForceLaw, Values
from vehicledyn.files.system.places import Place
from vehicledyn.multibody.model.ground import GROUND

FAMILIES = ("element", "sensor", "constraint")
"""Catalogues of system files that are made from those of the same name with _type."""

_VECTORS = ("polar", "axial", "sectional", "diagonal")
_RESERVED = {"kind", "family", "name"}


class DeclaredSet(SystemSet):
    """Base of the sets that are made from what a class declares."""

    made_from: ClassVar[type[Any]]

    @field_validator("*")
    @classmethod
    def _no_ground(cls, value: Any, info: ValidationInfo) -> Any:
        refusal = fact(cls, str(info.field_name), "no_ground")
        if refusal is not None and value == GROUND:
            raise ValueError(refusal)
        return value


def announce_elements() -> None:
    """Enter a set for each element of the catalogues that has none of its own."""
    for family in FAMILIES:
        for kind in set(kinds(f"{family}_type")) - set(kinds(family)):
            announce(family, kind, partial(_set_of_kind, family, kind))


def _set_of_kind(family: str, kind: str) -> type[DeclaredSet]:
    return declared_set(find(f"{family}_type", kind))  # type: ignore[arg-type]


@cache
def declared_set(entry: Any) -> type[DeclaredSet]:
    """Return the set of a class with declared fields.

    Raises
    ------
    InputError
        If the class is no dataclass, or a field is not declared.
    """
    where = f"{entry.__module__}.{entry.__qualname__}"
    if not hasattr(entry, "__dataclass_fields__"):
        raise InputError(f"{where} is no dataclass; write @dataclass(frozen=True) above it")
    try:
        hints = get_type_hints(entry)
    except NameError as error:
        raise InputError(f"{where}: {error}; import what annotations name") from None
    declared = {f.name: _field(f, hints[f.name], where) for f in _own_fields(entry)}
    made: type[DeclaredSet] = create_model(
        entry.__name__,
        __base__=DeclaredSet,
        __doc__=entry.__doc__,
        __module__=entry.__module__,
        **declared,
    )
    made.made_from = entry
    return made


def _own_fields(entry: type[Any]) -> Iterator[Field[Any]]:
    """Yield the fields of a class but the name that every part has."""
    return (f for f in fields(entry) if f.name != "name" and f.init)


def _field(field: Field[Any], hint: Any, where: str) -> Any:
    """Return annotation and field of a set."""
    facts = dict(field.metadata)
    what = facts.pop("declared", None)
    if what is None or field.name in _RESERVED:
        words = f"{where}: the field '{field.name}' has no declaration or a reserved name"
        raise InputError(f"{words}; declare it as in vehicledyn.multibody.model.declaration")
    is_expression = what in ("number", "vector", "function")
    is_vector = what == "vector" or facts.get("nature") in _VECTORS
    annotation: Any = {
        "attachment": Place,
        "name": str,
        "law": ForceLaw,
        "group": None,
    }.get(what, Vector if is_vector else Scalar if is_expression else hint)
    if what == "group":
        inner: Any = next(a for a in (hint, *getattr(hint, "__args__", ())) if is_dataclass(a))
        annotation = declared_set(inner)
    default = ... if field.default is MISSING else field.default
    if default is None:
        annotation = annotation | None
    elif is_expression and default is not ...:
        default = _written(facts.get("written", default), facts["measure"])
    facts.pop("written", None)
    description = facts.pop("description")
    extra = SetField(
        default=default,
        description=description,
        json_schema_extra=facts or None,
        ge=facts.get("least") if what == "choice" else None,
    )
    return annotation, extra


def _written(value: Any, unit: str) -> Expression:
    """Return the expression of a default, three numbers or one."""
    if isinstance(value, tuple | list):
        return read_expression([_with_unit(item, unit) for item in value])
    return read_expression(_with_unit(value, unit))


def _with_unit(value: Any, unit: str) -> Any:
    return value if value == 0 or unit in ("", "1") else f"{value!r} {unit}"


def coordinate_names(item: SystemSet) -> list[str]:
    """Return the coordinates that the fields of a set name, in the order of the fields."""
    names = type(item).model_fields
    return [getattr(item, n) for n in names if fact(type(item), n, "names") == "coordinate"]


def with_files_in(item: Any, folder: Path) -> Any:
    """Return a set whose names of files have the folder that they are relative to."""
    if not isinstance(item, DeclaredSet):
        return item
    changed = {}
    for name in type(item).model_fields:
        given = getattr(item, name)
        if isinstance(given, str) and fact(type(item), name, "is_file"):
            changed[name] = str(folder / given)
        elif isinstance(given, DeclaredSet):
            changed[name] = with_files_in(given, folder)
    return item.model_copy(update=changed) if changed else item


def element_of(item: DeclaredSet, name: str, value: Values, coordinates: Sequence[str]) -> Any:
    """Return the element that a set describes.

    Parameters
    ----------
    item
        The set.
    name
        Name of the element, empty for a group of fields inside one.
    value
        What an expression is worth.
    coordinates
        All of the system.
    """
    from vehicledyn.multibody.elements.point_forces import Attachment

    def built(field: str, given: Any) -> Any:
        if isinstance(given, Expression):
            return _function_of(item, field, given, value, coordinates)
        if isinstance(given, Place):
            return Attachment(given.body, value(given.point))
        if isinstance(given, ForceLaw):
            return lambda length, rate: given.tension(length, rate, value)
        if isinstance(given, DeclaredSet):
            return element_of(given, "", value, coordinates)
        return given

    own = {n: built(n, getattr(item, n)) for n in type(item).model_fields}
    named = {"name": name} if any(f.name == "name" for f in fields(item.made_from)) else {}
    try:
        return item.made_from(**named, **own)
    except (InputError, OverflowError) as error:
        head = f"{item.kind} '{name}': " if name else ""
        raise InputError(f"{head}{in_words(error)}") from None


def in_words(error: Exception) -> str:
    """Return what is wrong with the numbers of an element."""
    return "its numbers are too large" if isinstance(error, OverflowError) else str(error)


def _function_of(
    item: DeclaredSet, field: str, given: Expression, value: Values, coordinates: Sequence[str]
) -> Any:
    """Return what an expression is worth, or a function where it depends on the motion."""
    variables = fact(type(item), field, "variables")
    if variables is None:
        found = value(given)
        declared = {f.name: f.metadata.get("declared") for f in fields(item.made_from)}
        if declared[field] == "vector" and not isinstance(found, tuple | list):
            raise InputError(f"{field}: expected a vector, found one number")
        return found
    if variables == "time":
        return lambda time: value(given, time=time)
    from vehicledyn.files.system.sensors import motion_of

    return lambda situation: value(given, **motion_of(situation, coordinates))
