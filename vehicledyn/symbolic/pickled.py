"""Values with symbols in them as bytes: a symbol that occurs twice is one symbol afterwards, too.

CasADi refuses to pickle its expressions one by one, since each would get symbols of its own. Here
all of them are serialised together, and the pickled value refers to them by number.
"""

from __future__ import annotations

import io
import pickle
from typing import Any

import casadi as ca

UNPICKLABLE = (pickle.PicklingError, AttributeError, TypeError, ValueError, RecursionError)
"""Errors of a value that holds what cannot be pickled, such as a function within a function."""


def packed(value: Any) -> bytes:
    """Return a value as bytes.

    Raises
    ------
    UNPICKLABLE
        If something in it cannot be pickled.
    """
    stream = io.BytesIO()
    pickler = _Pickler(stream)
    pickler.dump(value)
    serializer = ca.StringSerializer()
    serializer.pack(pickler.expressions)
    return pickle.dumps((serializer.encode(), stream.getvalue()), pickle.HIGHEST_PROTOCOL)


def unpacked(content: bytes) -> Any:
    """Return the value of bytes that this program made; reading others may run any code."""
    return _unpickler(content).load()


def modules_of(content: bytes) -> set[str]:
    """Return the modules whose classes and functions a value needs where it is unpacked."""
    unpickler = _unpickler(content)
    unpickler.load()
    return unpickler.modules


class _Pickler(pickle.Pickler):
    """Keeps expressions out of the stream, each under the number of its place in a list."""

    def __init__(self, stream: io.BytesIO) -> None:
        super().__init__(stream, pickle.HIGHEST_PROTOCOL)
        self.expressions: list[ca.SX] = []
        self._places: dict[int, int] = {}

    def persistent_id(self, obj: Any) -> int | None:
        if not isinstance(obj, ca.SX):
            return None
        if id(obj) not in self._places:
            self._places[id(obj)] = len(self.expressions)
            self.expressions.append(obj)  # also keeps its address from being used again
        return self._places[id(obj)]


class _Unpickler(pickle.Unpickler):
    """Puts expressions back, and notes which modules are asked for."""

    def __init__(self, stream: io.BytesIO, expressions: list[ca.SX]) -> None:
        super().__init__(stream)
        self._expressions, self.modules = expressions, set[str]()

    def persistent_load(self, pid: int) -> ca.SX:
        return self._expressions[pid]

    def find_class(self, module: str, name: str) -> Any:
        self.modules.add(module)
        return super().find_class(module, name)


def _unpickler(content: bytes) -> _Unpickler:
    expressions, stream = pickle.loads(content)
    found = ca.StringDeserializer(expressions).unpack()
    return _Unpickler(io.BytesIO(stream), found)
