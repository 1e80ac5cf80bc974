"""Refuses arguments of another kind than a function of the front door annotates."""

from __future__ import annotations

import errno
import functools
import inspect
import operator
import os
import reprlib
import types
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import (
    Any,
    Literal,
    ParamSpec,
    SupportsFloat,
    SupportsIndex,
    TypeVar,
    Union,
    get_args,
    get_origin,
    get_type_hints,
)

from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError, nearest_name

P = ParamSpec("P")
R = TypeVar("R")

_WORDS: dict[Any, str] = {
    str: "a text",
    Path: "a path",
    bool: "True or False",
    int: "a whole number",
    float: "a number",
    type(None): "None",
    Mapping: "a mapping",
    Sequence: "a list",
    Iterable: "a list",
    tuple: "a tuple",
    Callable: "a function",
}

_LOADED = "what vehicledyn.load returned"


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """Return the function, which now refuses arguments of the wrong kind by their names.

    Raises
    ------
    InputError
        When called: if an argument is not what its annotation says.
    """
    signature = inspect.signature(function)
    hints = functools.cache(lambda: _hints(function))

    @functools.wraps(function)
    def call(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            given = signature.bind(*args, **kwargs)
        except TypeError:
            return function(*args, **kwargs)  # Python's own message names the function
        for name, value in given.arguments.items():
            kind = signature.parameters[name].kind
            if name not in hints() or kind is inspect.Parameter.VAR_KEYWORD:
                continue
            if kind is inspect.Parameter.VAR_POSITIONAL:
                given.arguments[name] = tuple(_taken(name, item, hints()[name]) for item in value)
            else:
                given.arguments[name] = _taken(name, value, hints()[name])
        try:
            return function(*given.args, **given.kwargs)
        except InputError as error:
            _name_argument(error, given.arguments)
            raise

    return call


def _name_argument(error: InputError, given: Mapping[str, Any]) -> None:
    """Put the name of an argument in front of an error that begins with its value in quotes.

    Where the error does not know its argument and several have this value, all are named.
    """
    text, names = str(error), list[str]()
    for name, value in given.items():
        items = value if isinstance(value, list | tuple | Mapping) else [value]
        texts = [str(item) for item in items if isinstance(item, str | Path)]
        quoted = (
            f"'{word}'" for item in texts for word in (item, item.removeprefix("parameters."))
        )
        if any(text.startswith(words) for words in quoted):
            names.append(name)
    names = [error.argument] if error.argument in names else names
    if names:
        error.args = (f"{' or '.join(map(argument, names))}: {text}", *error.args[1:])


def _hints(function: Callable[..., Any]) -> dict[str, Any]:
    """Return what the arguments are annotated with; what is returned may be known later."""
    texts = {name: hint for name, hint in function.__annotations__.items() if name != "return"}
    holder = types.SimpleNamespace(__annotations__=texts)
    return get_type_hints(holder, function.__globals__)


def _taken(name: str, value: Any, kind: Any) -> Any:
    """Return an argument that fits its annotation, arrays as lists, numbers as Python's own."""
    if hasattr(value, "tolist") and any(get_origin(m) in _LISTS for m in _members(kind)):
        value = value.tolist()
    _check(name, value, kind)
    if isinstance(value, str | Path) and Path in _members(kind):
        _check_path(name, value)
    return _plain(value, kind)


def _plain(value: Any, kind: Any) -> Any:
    """Return a value with numbers of other libraries, such as decimals, as Python's own."""
    if isinstance(value, float | int | str | Path):
        return value
    for member in _members(kind):
        origin = get_origin(member) or member
        if origin in _PLAIN and getattr(value, "shape", ()) == () and _fits(value, member):
            return _PLAIN[origin](value)
        if origin is Mapping and isinstance(value, Mapping) and get_args(member)[1] is not Any:
            return {key: _plain(item, get_args(member)[1]) for key, item in value.items()}
        if origin in _LISTS and isinstance(value, list | tuple):
            return type(value)(_plain(item, *get_args(member)) for item in value)
    return value


_PLAIN: dict[Any, Callable[[Any], Any]] = {bool: bool, int: operator.index, float: float}
_LISTS = (Iterable, Sequence, list)


def _check_path(name: str, value: str | Path) -> None:
    """Refuse what no file system takes as a path."""
    try:
        os.lstat(value)
    except (ValueError, OSError) as error:
        if getattr(error, "errno", errno.ENAMETOOLONG) != errno.ENAMETOOLONG:
            return
        words = getattr(error, "strerror", None) or str(error)
        shown = reprlib.repr(str(value))
        raise InputError(f"{argument(name)}: {shown} names no file: {words}") from None


def _check(name: str, value: Any, kind: Any) -> None:
    if _fits(value, kind):
        return
    choices = [c for item in _members(kind) if get_origin(item) is Literal for c in get_args(item)]
    near = nearest_name(value, choices) if choices and isinstance(value, str) else None
    hint = f"; did you mean '{near}'?" if near else ""
    found = reprlib.repr(value)
    raise InputError(f"{argument(name)}: expected {_words(kind)}, found {found}{hint}")


def _members(kind: Any) -> tuple[Any, ...]:
    """Return the kinds that an annotation joins."""
    return get_args(kind) if get_origin(kind) in (Union, types.UnionType) else (kind,)


def _fits(value: Any, kind: Any) -> bool:
    """Return whether a value is of an annotated kind."""
    if kind is Any:
        return True
    if len(_members(kind)) > 1:
        return any(_fits(value, member) for member in _members(kind))
    origin = get_origin(kind) or kind
    test = _TESTS.get(origin)
    return isinstance(value, origin) if test is None else test(value, *get_args(kind))


def _is_choice(value: Any, *choices: Any) -> bool:
    return isinstance(value, str) and value in choices


def _is_truth(value: Any) -> bool:
    """Return whether a value is True or False, NumPy's own among them."""
    return isinstance(value, bool) or (
        getattr(getattr(value, "dtype", None), "kind", "") == "b" and value.shape == ()
    )


def _is_whole_number(value: Any) -> bool:
    return isinstance(value, SupportsIndex) and _becomes_number(value, operator.index)


def _is_number(value: Any) -> bool:
    return isinstance(value, SupportsFloat) and _becomes_number(value, float)


def _becomes_number(value: Any, turned: Callable[[Any], float]) -> bool:
    """Return whether a value is one number; arrays of more look like numbers until asked."""
    if _is_truth(value):
        return False
    try:
        turned(value)
    except (TypeError, ValueError, OverflowError):
        return False
    return True


def _is_mapping(value: Any, keys: Any, items: Any) -> bool:
    return isinstance(value, Mapping) and all(
        _fits(key, keys) and _fits(item, items) for key, item in value.items()
    )


def _is_list(value: Any, items: Any) -> bool:
    """Return whether a value is a list of some items; what iterators give is not looked at."""
    if isinstance(value, list | tuple):
        return all(_fits(item, items) for item in value)
    return isinstance(value, Iterable) and not isinstance(value, str | bytes | Mapping)


def _is_tuple(value: Any, *items: Any) -> bool:
    return isinstance(value, tuple | list) and len(value) == len(items)


_TESTS: dict[Any, Callable[..., bool]] = {
    Literal: _is_choice,
    bool: _is_truth,
    int: _is_whole_number,
    float: _is_number,
    Mapping: _is_mapping,
    Iterable: _is_list,
    Sequence: _is_list,
    list: _is_list,
    tuple: _is_tuple,
    Callable: lambda value, *_: callable(value),
}


def _words(kind: Any) -> str:
    """Return what an annotation asks for, as a phrase."""
    parts: list[str] = []
    for member in _members(kind):
        origin = get_origin(member) or member
        if origin is Literal:
            parts += [repr(choice) for choice in get_args(member)]
        elif origin is Mapping and get_args(member)[1] is not Any:
            parts.append(f"a mapping from names to {_plural(get_args(member)[1])}")
        elif origin in _LISTS and get_args(member)[0] is not Any:
            parts.append(f"a list of {_plural(get_args(member)[0])}")
        elif origin is tuple:
            parts.append(f"a tuple of {len(get_args(member))}")
        else:
            loaded = getattr(origin, "__name__", "").startswith("Loaded")
            parts.append(_LOADED if loaded else _WORDS.get(origin, f"a {origin.__name__}"))
    return _choice(parts)


def _plural(kind: Any) -> str:
    """Return what an annotation of items asks for, as a phrase in the plural."""
    words = [_words(member) for member in _members(kind)]
    return _choice([f"{word.removeprefix('a ')}s" if word in _SINGULAR else word for word in words])


_SINGULAR = {word for word in _WORDS.values() if word.startswith("a ")}


def _choice(parts: list[str]) -> str:
    *first, last = dict.fromkeys(parts)
    return f"{', '.join(first)} or {last}" if first else last
