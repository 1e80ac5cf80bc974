"""Catalogues: a part registers itself under a family and a name, and is found by both.

What a catalogue holds is read from the text of its modules, and a module is imported when one of
its entries is first asked for: who names one part does not wait for all the others.
"""

from __future__ import annotations

import importlib
import pkgutil
import re
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any, TypeVar

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.version import PACKAGE

_catalogues: dict[str, dict[str, type[Any] | str | Callable[[], type[Any]]]] = {}
"""Class of each entry by family and name, or the module that will register it, or its maker."""

_publishing = threading.Lock()
"""Held while a made class is entered, never while foreign code runs, which imports and waits."""

_WRITTEN = re.compile(rb'^@register\("(\w+)", "(\w+)"\)', re.MULTILINE)

T = TypeVar("T")


def register(family: str, name: str) -> Callable[[type[T]], type[T]]:
    """Return a class decorator that enters the class in a catalogue.

    The class gets two class attributes, ``family`` and ``kind``, with these names. One that lacks
    methods of its family raises ValueError.
    """

    def enter(entry: type[T]) -> type[T]:
        catalogue = _catalogues.setdefault(family, {})
        holder = _holder(catalogue.get(name))
        if holder not in ("", entry.__module__) or _is_another(catalogue.get(name), entry):
            raise ValueError(f"{family} '{name}' is registered twice; {_place(holder)} has it")
        missing = sorted(getattr(entry, "__abstractmethods__", ()))
        if missing:
            raise ValueError(f"{family} '{name}' lacks {', '.join(missing)}, which its class needs")
        return _entered(family, name, entry)

    return enter


def _entered(family: str, name: str, entry: type[T]) -> type[T]:
    entry.family = family  # type: ignore[attr-defined]
    entry.kind = name  # type: ignore[attr-defined]
    _catalogues[family][name] = entry
    return entry


def _holder(known: type[Any] | str | Callable[[], type[Any]] | None) -> str:
    """Return the module that an entry of a catalogue is from, empty for none."""
    return known if isinstance(known, str) else getattr(known, "__module__", "")


def _place(module: str) -> str:
    """Return where a module is to be found: its name, of one of the user's own its file."""
    file = getattr(sys.modules.get(module), "__file__", None)
    return module if file is None or module.partition(".")[0] == PACKAGE else str(file)


def _is_another(known: Any, entry: type[Any]) -> bool:
    return isinstance(known, type) and known.__qualname__ != entry.__qualname__


@contextmanager
def all_or_nothing() -> Iterator[list[tuple[str, str]]]:
    """Give the list of what the block registers, complete at its end; undo it after an error."""
    before = _foreign_entries()
    found: list[tuple[str, str]] = []
    try:
        yield found
    except BaseException:
        for family, name in _foreign_entries() - before:
            del _catalogues[family][name]
            if not _catalogues[family]:
                del _catalogues[family]
        raise
    new = sorted(_foreign_entries() - before)
    found += [(family, name) for family, name in new if _is_registered(family, name)]


def _foreign_entries() -> set[tuple[str, str]]:
    """Return the entries that are not this package's own."""
    return {
        (family, name)
        for family, catalogue in list(_catalogues.items())
        for name, entry in list(catalogue.items())
        if _holder(entry).partition(".")[0] != PACKAGE
    }


def own_families() -> tuple[str, ...]:
    """Return the catalogues of which no entry is this package's, sorted."""
    foreign = {entry for entry in _foreign_entries() if _is_registered(*entry)}
    return tuple(f for f in families() if all((f, name) in foreign for name in _catalogues[f]))


def _is_registered(family: str, name: str) -> bool:
    """Return whether an entry was registered, not announced."""
    return isinstance(_catalogues[family][name], type | str)


def announce(family: str, name: str, make: Callable[[], type[Any]]) -> None:
    """Enter a class that is made when it is first asked for, unless the name is taken."""
    _catalogues.setdefault(family, {}).setdefault(name, make)


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
    found = catalogue.get(name)
    if isinstance(found, str):
        importlib.import_module(found)
        found = catalogue[name]
    if found is not None and not isinstance(found, type | str):
        found = _published(family, name, found, found())
    if not isinstance(found, type):
        raise InputError(unknown_name(family, name, kinds(family)))
    return found


def _published(family: str, name: str, maker: Any, made: type[Any]) -> Any:
    """Enter a class in the place of its maker; return that of another thread, were it first."""
    catalogue = _catalogues[family]
    with _publishing:
        is_first = catalogue[name] is maker
        return _entered(family, name, made) if is_first else catalogue[name]


def discover(package: str, path: Iterable[str]) -> None:
    """Enter all that the modules of a catalogue's package register.

    A module is read, not imported, where each of its calls is a decorator ``@register("family",
    "name")`` on a line of its own.

    Raises
    ------
    ValueError
        If two modules register the same name.
    """
    for module in pkgutil.iter_modules(list(path)):
        name = f"{package}.{module.name}"
        text = _text_of(module)
        calls = None if text is None else text.count(b"register(")
        entries = _WRITTEN.findall(text) if text and calls else []
        if len(entries) != calls:
            importlib.import_module(name)
            continue
        for family, kind in ((a.decode(), b.decode()) for a, b in entries):
            known = _catalogues.setdefault(family, {}).setdefault(kind, name)
            if name not in (known, getattr(known, "__module__", None)):
                raise ValueError(f"{family} '{kind}' is registered twice")


def _text_of(module: pkgutil.ModuleInfo) -> bytes | None:
    """Return the source of a module, None where it cannot be read."""
    folder = getattr(module.module_finder, "path", None)
    if folder is None or module.ispkg:
        return None
    try:
        with open(f"{folder}/{module.name}.py", "rb") as file:  # noqa: PTH123
            return file.read()
    except OSError:
        return None
