"""The first 48 bytes of an HDF5 file: whether it is open for writing with readers.

HDF5 sets both consistency flags only with its own file drivers. We write through a file
object (see :mod:`vehicledyn.results.hdf5.disk`), so the flag it leaves out is set here.

References
----------
The HDF Group, HDF5 File Format Specification 3.0, section II.A (superblock version 3).
Jenkins (2006), lookup3.c, public domain: the checksum HDF5 uses.
"""

from __future__ import annotations

import struct

SIGNATURE = b"\x89HDF\r\n\x1a\n"
SIZE = 48

_VERSION_AT = 8
_FLAGS_AT = 11
_END_AT = 28
_CHECKSUM_AT = 44
_WRITING = 0x01
_WITH_READERS = 0x04
_MASK = 0xFFFFFFFF


def is_open_with_readers(start: bytes) -> bool:
    """Return whether a file's first bytes say that it is written, or was left, with readers."""
    return (
        len(start) > _FLAGS_AT
        and start[_VERSION_AT] >= 3
        and bool(start[_FLAGS_AT] & _WITH_READERS)
    )


def with_writing_flag(start: bytes) -> bytes:
    """Return a superblock of 48 bytes with the flag that a writer has the file open."""
    marked = bytearray(start)
    marked[_FLAGS_AT] |= _WRITING
    marked[_CHECKSUM_AT:] = struct.pack("<I", lookup3(bytes(marked[:_CHECKSUM_AT])))
    return bytes(marked)


def as_closed(start: bytes, size: int) -> bytes:
    """Return a superblock of 48 bytes as if the file had been closed, for one left by a kill.

    What lies behind the end that the superblock knows is kept: ``size`` is that of the file.
    """
    marked = bytearray(start)
    marked[_FLAGS_AT] &= ~(_WRITING | _WITH_READERS) & 0xFF
    struct.pack_into("<Q", marked, _END_AT, max(end_of(start), size))
    marked[_CHECKSUM_AT:] = struct.pack("<I", lookup3(bytes(marked[:_CHECKSUM_AT])))
    return bytes(marked)


def end_of(start: bytes) -> int:
    """Return where a superblock says that its file ends [bytes]."""
    return int(struct.unpack_from("<Q", start, _END_AT)[0])


def has_tail(start: bytes, size: int) -> bool:
    """Return whether a file of a size [bytes] goes on behind the end that its superblock knows."""
    return len(start) == SIZE and start[_VERSION_AT] >= 3 and end_of(start) < size


def lookup3(data: bytes) -> int:
    """Return Jenkins' 32-bit hash of some bytes, with initial value zero.

    >>> hex(lookup3(b"Four score and seven years ago"))
    '0x17770551'
    """
    a = b = c = (0xDEADBEEF + len(data)) & _MASK
    words = struct.unpack(f"<{-(-len(data) // 12) * 3}I", data + bytes(-len(data) % 12))
    for index in range(0, len(words), 3):
        a, b, c = (
            (value + word) & _MASK
            for value, word in zip((a, b, c), words[index : index + 3], strict=True)
        )
        if index + 3 < len(words):
            a, b, c = _mix(a, b, c)
    return _finish(a, b, c) if words else c


def _rotate(value: int, bits: int) -> int:
    return ((value << bits) | (value >> (32 - bits))) & _MASK


def _mix(a: int, b: int, c: int) -> tuple[int, int, int]:
    for bits in (4, 6, 8, 16, 19, 4):
        a = ((a - c) & _MASK) ^ _rotate(c, bits)
        c = (c + b) & _MASK
        a, b, c = b, c, a
    return a, b, c


def _finish(a: int, b: int, c: int) -> int:
    for bits in (14, 11, 25, 16, 4, 14, 24):
        c = ((c ^ b) - _rotate(b, bits)) & _MASK
        a, b, c = b, c, a
    return b
