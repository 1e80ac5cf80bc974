"""Remembers results of expensive steps by what they depend on, also for a later process.

Results become plain bytes and back, numbers to the last bit; only the kinds of values below are
known, so that reading them runs no code of a file.
"""

from __future__ import annotations

import hashlib
import json
import struct
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, Protocol

import numpy as np

from vehicledyn.base.errors import NumericalError

_SIZE = struct.Struct("<I")


class Store(Protocol):
    """Keeps bytes by keys of 32 bytes."""

    def get(self, key: bytes) -> bytes | None:
        """Return what is kept."""

    def put(self, key: bytes, data: bytes) -> None:
        """Keep something."""


@dataclass(frozen=True)
class Memory:
    """Results of steps in a store, of values of some ``kinds`` of data classes and errors."""

    store: Store
    kinds: Mapping[str, type]

    def recall(self, name: str, given: Any, compute: Callable[[], Any]) -> Any:
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
        key = digest((name, given))
        data = self.store.get(key)
        if data is None:
            data = encode(compute())
            self.store.put(key, data)
        return decode(data, self.kinds)

    def recall_or_raise(self, name: str, given: Any, compute: Callable[[], Any]) -> Any:
        """Return the result of a step, or raise the error in which it ended.

        Raises
        ------
        NumericalError
            If the step ended in one.
        """

        def tried() -> tuple[Any, str]:
            try:
                return compute(), ""
            except NumericalError as error:
                return None, str(error)

        result, error = self.recall(name, given, tried)
        if error:
            raise NumericalError(error)
        return result


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
        for item in fields(value):
            _feed(found, getattr(value, item.name))
    elif isinstance(value, tuple | list):
        found.update(f"[{len(value)}".encode())
        for entry in value:
            _feed(found, entry)
    elif isinstance(value, dict):
        _feed(found, sorted(value.items(), key=lambda item: repr(item[0])))
    elif isinstance(value, float):
        found.update(struct.pack("<cd", b"f", value))
    elif value is None or isinstance(value, str | bool | int | np.integer | np.bool_):
        found.update(f"'{value!s}'".encode())
    else:
        raise TypeError(f"a {type(value).__name__} has no digest")


def _plain(value: Any, arrays: list[bytes]) -> Any:
    """Return what JSON can hold, and append the bytes of arrays."""
    if isinstance(value, np.ndarray):
        begin = sum(map(len, arrays))
        arrays.append(np.ascontiguousarray(value).tobytes())
        return {"array": [value.dtype.str, list(value.shape), begin]}
    if is_dataclass(value) and not isinstance(value, type):
        parts = [_plain(getattr(value, item.name), arrays) for item in fields(value)]
        return {"kind": [type(value).__name__, *parts]}
    if isinstance(value, tuple | list):
        return {"tuple": [_plain(entry, arrays) for entry in value]}
    if isinstance(value, str) and type(value) is not str:
        return {"kind": [type(value).__name__, str(value)]}
    if isinstance(value, np.generic):
        return value.item()
    if value is None or isinstance(value, bool | int | float | str):
        return value
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
    if what == "tuple":
        return tuple(_value(entry, rest, kinds) for entry in held)
    name, *parts = held
    return kinds[name](*(_value(part, rest, kinds) for part in parts))
