"""The heaps in which HDF5 keeps texts and references: whether their chain of objects ends.

HDF5 reads such a heap object by object and trusts each for the place of the next. An object of
no size, as zeroed bytes are, makes it read the same one for ever, so the chain is followed
here before HDF5 sees it.

References
----------
The HDF Group, HDF5 File Format Specification 3.0, section III.E (global heap).
"""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator

from vehicledyn.results.hdf5.seal import DamagedError

SIGNATURE = b"GCOL"
HEAD = struct.Struct("<4sB3sQ")
"""Signature, version, reserved bytes and size of a heap."""

_OBJECT = struct.Struct("<HH4sQ")
_ALIGNMENT = 8

Read = Callable[[int, int], bytes]
"""Returns a number of bytes from an offset."""


def heaps_in(data: bytes, offset: int) -> Iterator[int]:
    """Yield the offsets in the file of all heaps that begin in bytes read from an offset."""
    place = data.find(SIGNATURE)
    while place >= 0:
        head = data[place : place + HEAD.size]
        if len(head) == HEAD.size and head[4:8] == b"\1\0\0\0":
            yield offset + place
        place = data.find(SIGNATURE, place + 1)


def check_heap(read: Read, offset: int, end: int) -> None:
    """Follow the objects of a heap.

    Parameters
    ----------
    read
        Reads the file.
    offset
        Where the heap begins [bytes].
    end
        Where the file ends [bytes].

    Raises
    ------
    DamagedError
        If the chain of its objects does not end where the heap does.
    """
    size = HEAD.unpack(read(HEAD.size, offset))[3]
    if size < HEAD.size or offset + size > end:
        raise _damaged(offset, offset + HEAD.size)
    data = read(size, offset)
    place = HEAD.size
    while size - place >= _OBJECT.size:
        index, _, _, length = _OBJECT.unpack_from(data, place)
        # The size of object 0, the free space, counts its own head; that of others does not.
        step = length if index == 0 else _OBJECT.size + -(-length // _ALIGNMENT) * _ALIGNMENT
        if step < _OBJECT.size or place + step > size:
            raise _damaged(offset, offset + size)
        place += step


def _damaged(first: int, last: int) -> DamagedError:
    return DamagedError(f"its heap of texts at byte {first} is broken", first, last)
