"""Values within mappings and lists, whatever these are within."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any


def leaves(data: Any) -> Iterator[Any]:
    """Yield what nested mappings and lists hold in the end, one after the other.

    >>> list(leaves({"a": [1, {"b": (2, 3)}], "c": "four"}))
    [1, 2, 3, 'four']
    """
    if isinstance(data, dict):
        data = data.values()
    elif not isinstance(data, list | tuple):
        yield data
        return
    for item in data:
        yield from leaves(item)
