"""Data classes whose ``__init__`` is written when it is first used.

The standard library writes and compiles up to six methods for each data class while its module is
imported. A command that reads a file imports a hundred data classes and makes objects of a part
of them: writing the methods took 50 ms, a sixth of the time of ``validate``.
"""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Callable, Iterable
from dataclasses import MISSING, Field, FrozenInstanceError
from inspect import get_annotations
from operator import attrgetter
from reprlib import recursive_repr
from typing import TYPE_CHECKING, Any

__all__ = ["dataclass"]


def _dataclass(
    entry: type[Any] | None = None,
    /,
    *,
    frozen: bool = False,
    eq: bool = True,
    repr: bool = True,
    kw_only: bool = False,
) -> Any:
    """Make a data class as :func:`dataclasses.dataclass` does, with an ``__init__`` written late.

    A class without a docstring, or with ``InitVar`` or ``KW_ONLY`` among its annotations, is
    given to the standard library.
    """

    def make(entry: Any) -> Any:
        if entry.__doc__ is None or _has_markers(entry):
            return dataclasses.dataclass(frozen=frozen, eq=eq, repr=repr, kw_only=kw_only)(entry)
        return _made(entry, frozen, eq, repr, kw_only)

    return make if entry is None else make(entry)


if TYPE_CHECKING:
    from dataclasses import dataclass
else:
    dataclass = _dataclass


def _has_markers(entry: type[Any]) -> bool:
    """Return whether annotations say more than the types of fields."""
    written = map(str, get_annotations(entry).values())
    return any("InitVar" in text or "KW_ONLY" in text for text in written)


def _made(entry: Any, frozen: bool, eq: bool, shown: bool, kw_only: bool) -> Any:
    bases = [base for base in entry.__mro__[1:] if "__dataclass_fields__" in base.__dict__]
    has_frozen_base = any(base.__dataclass_params__.frozen for base in bases)
    if bases and frozen and not has_frozen_base:
        raise TypeError("cannot inherit frozen dataclass from a non-frozen one")
    own = set(entry.__dict__)
    collect = dataclasses.dataclass(
        init=False, repr=False, eq=False, kw_only=kw_only, frozen=frozen and has_frozen_base
    )
    collect(entry)  # finds the fields; it writes methods only where a base is frozen, too
    parameters = entry.__dataclass_params__
    parameters.init, parameters.repr, parameters.eq, parameters.frozen = True, shown, eq, frozen
    fields = dataclasses.fields(entry)
    _check_order(fields)
    if "__init__" not in own:
        entry.__init__ = _Initialiser(entry, frozen)
    if shown and "__repr__" not in own:
        _give(entry, "__repr__", _text_of([field.name for field in fields if field.repr]))
    if eq:
        _give_comparison(entry, fields, frozen, own)
    if frozen and not has_frozen_base:
        _freeze(entry, {field.name for field in fields}, own)
    return entry


def _give(entry: Any, name: str, function: Any) -> None:
    function.__name__, function.__qualname__ = name, f"{entry.__qualname__}.{name}"
    setattr(entry, name, function)


def _check_order(fields: Iterable[Field[Any]]) -> None:
    has_default = False
    for field in fields:
        if not field.init or field.kw_only:
            continue
        if not _is_required(field):
            has_default = True
        elif has_default:
            raise TypeError(f"non-default argument {field.name!r} follows default argument")


def _is_required(field: Field[Any]) -> bool:
    return field.default is MISSING and field.default_factory is MISSING


def _text_of(names: list[str]) -> Callable[[Any], str]:
    def represent(self: Any) -> str:
        content = ", ".join([f"{name}={getattr(self, name)!r}" for name in names])
        return f"{self.__class__.__qualname__}({content})"

    return recursive_repr()(represent)


def _values(names: list[str]) -> Callable[[Any], Any]:
    """Return a function that gives the values of an object's fields as a tuple."""
    if len(names) > 1:
        return attrgetter(*names)
    return (lambda item: (getattr(item, names[0]),)) if names else (lambda item: ())


def _give_comparison(entry: Any, fields: Iterable[Field[Any]], frozen: bool, own: set[str]) -> None:
    has_own_hash = "__hash__" in own and not (entry.__hash__ is None and "__eq__" in own)
    if "__eq__" not in own:
        compared = _values([field.name for field in fields if field.compare])

        def equal(self: Any, other: Any) -> Any:
            same = other.__class__ is self.__class__
            return compared(self) == compared(other) if same else NotImplemented

        _give(entry, "__eq__", equal)
    if has_own_hash:
        return
    if not frozen:
        entry.__hash__ = None
        return
    hashed = _values([f.name for f in fields if (f.compare if f.hash is None else f.hash)])
    _give(entry, "__hash__", lambda self: hash(hashed(self)))


def _freeze(entry: Any, names: set[str], own: set[str]) -> None:
    def assign(self: Any, name: str, value: Any) -> None:
        if type(self) is entry or name in names:
            raise FrozenInstanceError(f"cannot assign to field {name!r}")
        super(entry, self).__setattr__(name, value)

    def delete(self: Any, name: str) -> None:
        if type(self) is entry or name in names:
            raise FrozenInstanceError(f"cannot delete field {name!r}")
        super(entry, self).__delattr__(name)

    for name, function in (("__setattr__", assign), ("__delattr__", delete)):
        if name in own:
            raise TypeError(f"Cannot overwrite attribute {name} in class {entry.__name__}")
        _give(entry, name, function)


class _Initialiser:
    """Stands for the ``__init__`` of a class until somebody asks for it."""

    def __init__(self, entry: type[Any], frozen: bool) -> None:
        self._entry, self._frozen = entry, frozen

    def __get__(self, item: Any, entry: Any = None) -> Any:
        written = self._entry.__dict__["__init__"]
        if written is self:
            written = _initialiser(self._entry, self._frozen)
            type.__setattr__(self._entry, "__init__", written)
        return written.__get__(item, entry)


class _Factory:
    """Stands for a default that is made anew for each object."""

    def __repr__(self) -> str:
        return "<factory>"


_FACTORY = _Factory()


def _initialiser(entry: Any, frozen: bool) -> Any:
    """Return the ``__init__`` of a data class, compiled."""
    fields = dataclasses.fields(entry)
    me = "__dataclass_self__" if any(field.name == "self" for field in fields) else "self"
    known: dict[str, Any] = {"__dataclass_set__": object.__setattr__}
    known["__dataclass_factory__"] = _FACTORY
    body = [line for field in fields for line in _assignment(field, me, frozen, known)]
    if hasattr(entry, "__post_init__"):
        body.append(f"{me}.__post_init__()")
    positional = [field for field in fields if field.init and not field.kw_only]
    named = [field for field in fields if field.init and field.kw_only]
    asked = [me, *map(_argument, positional), *(["*"] if named else []), *map(_argument, named)]
    text = "\n  ".join([f" def __init__({', '.join(asked)}):", *(body or ["pass"])])
    made: dict[str, Any] = {}
    module = sys.modules.get(entry.__module__)
    source = f"def __make__({', '.join(known)}):\n{text}\n return __init__"
    exec(source, {} if module is None else module.__dict__, made)
    written = made["__make__"](**known)
    written.__qualname__ = f"{entry.__qualname__}.__init__"
    types = {field.name: field.type for field in (*positional, *named)}
    written.__annotations__ = {**types, "return": None}
    return written


def _argument(field: Field[Any]) -> str:
    if field.default is not MISSING:
        return f"{field.name}=__default_{field.name}__"
    factory = field.default_factory is not MISSING
    return f"{field.name}=__dataclass_factory__" if factory else field.name


def _assignment(field: Field[Any], me: str, frozen: bool, known: dict[str, Any]) -> list[str]:
    """Return the line that sets a field; enter its default among what the function knows."""
    name, default = field.name, f"__default_{field.name}__"
    if field.default_factory is not MISSING:
        known[default] = field.default_factory
        given = f"{default}() if {name} is __dataclass_factory__ else {name}"
        value = given if field.init else f"{default}()"
    elif field.init:
        known[default] = field.default
        value = name
    else:
        return []
    return [f"__dataclass_set__({me}, {name!r}, {value})" if frozen else f"{me}.{name} = {value}"]
