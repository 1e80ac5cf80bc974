"""Catalogues: a part registers itself under a family and a name, and is found by both."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

from vehicledyn.base.errors import InputError, unknown_name

_catalogues: dict[str, dict[str, type[Any]]] = {}

T = TypeVar("T")


def register(family: str, name: str) -> Callable[[type[T]], type[T]]:
    """Return a class decorator that enters the class in a catalogue.

    The class gets two class attributes, ``family`` and ``kind``, with these names.
    """

    def enter(entry: type[T]) -> type[T]:
        catalogue = _catalogues.setdefault(family, {})
        known = catalogue.get(name)
        if known is not None and known.__qualname__ != entry.__qualname__:
            raise ValueError(f"{family} '{name}' is registered twice")
        entry.family = family  # type: ignore[attr-defined]
        entry.kind = name  # type: ignore[attr-defined]
        catalogue[name] = entry
        return entry

    return enter


def families() -> tuple[str, ...]:
    """Return the names of all catalogues, sorted."""
    return tuple(sorted(_catalogues))


def kinds(family: str) -> tuple[str, ...]:
    """Return the names registered under a family, sorted."""
    return tuple(sorted(_catalogues.get(family, {})))


def find(family: str, name: str) -> type[Any]:
    """Return the class registered under a family and a name.

    Raises
    ------
    InputError
        If there is none; the message suggests the nearest name.
    """
    catalogue = _catalogues.get(family, {})
    if name not in catalogue:
        raise InputError(unknown_name(family, name, catalogue))
    return catalogue[name]


def discover(package: str, path: Iterable[str]) -> None:
    """Import every module of a catalogue's package, so that its entries register themselves."""
    for module in pkgutil.iter_modules(list(path)):
        importlib.import_module(f"{package}.{module.name}")
