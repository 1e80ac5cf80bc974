"""Remembers results of expensive steps by what they depend on, also for a later process.

Results become plain bytes and back, numbers to the last bit; only the kinds of values below are
known, so that reading them runs no code of a file. What cannot be read is computed again.
"""

from __future__ import annotations

import hashlib
import json
import struct
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import fields, is_dataclass
from typing import Any, Protocol, TypeVar

import numpy as np

from vehicledyn.base.errors import NumericalError

T = TypeVar("T")

_SIZE = struct.Struct("<I")
_CONTAINERS: dict[str, Callable[[Iterable[Any]], Any]] = {
    "tuple": tuple,
    "list": list,
    "dict": dict,
}
_UNREADABLE = (ValueError, TypeError, LookupError, RecursionError, struct.error)


class Store(Protocol):
    """Keeps bytes by keys of 32 bytes."""

    def get(self, key: bytes) -> bytes | None:
        """Return what is kept."""

    def put(self, key: bytes, data: bytes) -> None:
        """Keep something."""


class Shelf(dict[bytes, bytes]):
    """Keeps results as long as the process lives."""

    put = dict.__setitem__


class Memory:
    """Results of steps in a store, of values of some ``kinds`` of data classes and errors.

    Parameters
    ----------
    store
        Where they are; None to compute every step.
    kinds
        Data classes, named tuples and enumerations among the results.
    n_known
        How many results an earlier process has left in the store.
    """

    def __init__(
        self, store: Store | None = None, kinds: Iterable[type] = (), n_known: int = 0
    ) -> None:
        self._store, self._kinds = store, {kind.__name__: kind for kind in kinds}
        self.n_known = n_known

    def recall(self, name: str, given: Any, compute: Callable[[], T]) -> T:
        """Return the result of a step, from the store if it is there.

        Parameters
        ----------
        name
            Name of the step.
        given
            All that the result depends on.
        compute
            Makes the result.
        """
        if self._store is None:
            return compute()
        key = digest((name, given))
        data = self._store.get(key)
        if data is not None:
            with suppress(*_UNREADABLE):
                return self._decoded(data)  # type: ignore[no-any-return]
        data = encode(compute())
        self._store.put(key, data)
        return self._decoded(data)  # type: ignore[no-any-return]

    def recall_or_raise(
        self,
        name: str,
        given: Any,
        compute: Callable[[], T],
        kind: type[Exception] = NumericalError,
    ) -> T:
        """Return the result of a step, or raise the error of a kind in which it ended."""

        def tried() -> tuple[Any, str]:
            try:
                return compute(), ""
            except kind as error:
                return None, str(error)

        result, error = self.recall(name, given, tried)
        if error:
            raise kind(error)
        return result  # type: ignore[no-any-return]

    def _decoded(self, data: bytes) -> Any:
        return decode(data, self._kinds)


def digest(value: Any) -> bytes:
    """Return 32 bytes that differ for values that differ in any bit."""
    found = hashlib.sha256()
    _feed(found, value)
    return found.digest()


def encode(value: Any) -> bytes:
    """Return a value as bytes.

    Raises
    ------
    TypeError
        If it is of no kind that can be stored.
    """
    arrays: list[bytes] = []
    tree = json.dumps(_plain(value, arrays)).encode()
    return b"".join([_SIZE.pack(len(tree)), tree, *arrays])


def decode(data: bytes, kinds: Mapping[str, type]) -> Any:
    """Return the value of some bytes, its data classes and enumerations among ``kinds``."""
    (size,) = _SIZE.unpack_from(data)
    tree = json.loads(data[_SIZE.size : _SIZE.size + size])
    return _value(tree, memoryview(data)[_SIZE.size + size :], kinds)


def _feed(found: Any, value: Any) -> None:
    if isinstance(value, np.ndarray):
        found.update(f"{value.dtype.str}{value.shape}".encode())
        found.update(np.ascontiguousarray(value).tobytes())
    elif is_dataclass(value) and not isinstance(value, type):
        found.update(f"<{type(value).__name__}".encode())
        for item in _values(value):
            _feed(found, item)
    elif isinstance(value, tuple | list):
        found.update(f"[{len(value)}".encode())
        for entry in value:
            _feed(found, entry)
    elif isinstance(value, dict):
        _feed(found, sorted(value.items(), key=lambda item: repr(item[0])))
    elif isinstance(value, float):
        found.update(struct.pack("<cd", b"f", value))
    elif isinstance(value, complex):
        found.update(struct.pack("<cdd", b"c", value.real, value.imag))
    elif value is None or isinstance(value, str | bool | int | np.integer | np.bool_):
        found.update(f"'{value!s}'".encode())
    else:
        raise TypeError(f"a {type(value).__name__} has no digest")


def _values(value: Any) -> list[Any]:
    return [getattr(value, item.name) for item in fields(value)]


def _plain(value: Any, arrays: list[bytes]) -> Any:
    """Return what JSON can hold, and append the bytes of arrays."""
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, bool | int | float) or type(value) is str:
        return value
    if isinstance(value, np.ndarray):
        begin = sum(map(len, arrays))
        arrays.append(np.ascontiguousarray(value).tobytes())
        return {"array": [value.dtype.str, list(value.shape), begin]}
    if hasattr(value, "_fields") or (is_dataclass(value) and not isinstance(value, type)):
        parts = value if isinstance(value, tuple) else _values(value)
        return {"kind": [type(value).__name__, *(_plain(part, arrays) for part in parts)]}
    if isinstance(value, tuple | list | dict):
        items = value.items() if isinstance(value, dict) else value
        return {type(value).__name__: [_plain(entry, arrays) for entry in items]}
    if isinstance(value, str):
        return {"kind": [type(value).__name__, str(value)]}
    if isinstance(value, complex):
        return {"complex": [value.real, value.imag]}
    raise TypeError(f"a {type(value).__name__} cannot be stored")


def _value(tree: Any, rest: memoryview, kinds: Mapping[str, type]) -> Any:
    if not isinstance(tree, dict):
        return tree
    ((what, held),) = tree.items()
    if what == "array":
        kind, shape, begin = held
        dtype = np.dtype(kind)
        count = int(np.prod(shape, dtype=int))
        flat = np.frombuffer(rest[begin : begin + count * dtype.itemsize], dtype)
        return flat.reshape(shape).copy()
    if what == "complex":
        return complex(*held)
    if what in _CONTAINERS:
        return _CONTAINERS[what](_value(entry, rest, kinds) for entry in held)
    name, *parts = held
    return kinds[name](*(_value(part, rest, kinds) for part in parts))
