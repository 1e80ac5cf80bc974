"""Changing bytes all over a file at once: all of them, or none after a kill or a full disk.

New bytes go behind the end of the file, where nothing refers to them yet, and the seal behind
them. Those that replace others follow as a journal with a checksum, and are written to their
places after that. Whoever opens a file that ends in a journal reads through it.
"""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO

from vehicledyn.results.hdf5.seal import Patch, read_seal, seal_of, write_all

MAGIC = b"\x89VDJRNL\n"

_FOOTER = struct.Struct("<8sQQI")
_ENTRY = struct.Struct("<QQ")


@dataclass(frozen=True)
class Journal:
    """What replaces bytes of the first ``body`` bytes of a file."""

    body: int
    patches: tuple[Patch, ...]


def commit(file: IO[bytes], patches: Sequence[Patch], body: int) -> None:
    """Change an unbuffered file, which then has ``body`` bytes and its seal.

    Raises
    ------
    OSError
        If it cannot be written; nothing is changed then.
    """
    size = file.seek(0, os.SEEK_END)
    inside = [(start, new[: size - start]) for start, new in patches if start < size]
    try:
        for start, new in patches:
            behind = max(start, size)
            if start + len(new) > behind:
                file.seek(behind)
                write_all(file, new[behind - start :])
        file.truncate(body)
        seal = seal_of(file, body, inside)
        file.seek(body)
        write_all(file, seal + _packed(inside, body + len(seal)))
    except OSError:
        file.truncate(size)
        raise
    for start, new in inside:
        file.seek(start)
        write_all(file, new)
    file.truncate(body + len(seal))


def read_journal(number: int, size: int) -> Journal | None:
    """Return the journal of an open file (its descriptor) of a size, None if it has none whole."""
    footer = os.pread(number, _FOOTER.size, max(0, size - _FOOTER.size))
    if len(footer) < _FOOTER.size or not footer.startswith(MAGIC):
        return None
    _, body, length, crc = _FOOTER.unpack(footer)
    if body + length + _FOOTER.size != size:
        return None
    data = os.pread(number, length, body)
    if len(data) != length or zlib.crc32(data) != crc:
        return None
    patches, place = [], 0
    while place < length:
        start, count = _ENTRY.unpack_from(data, place)
        place += _ENTRY.size
        patches.append((start, data[place : place + count]))
        place += count
    return Journal(body, tuple(patches))


def reopen(path: Path) -> None:
    """Take the seal off a file, or do what its journal says, so that it can be written again."""
    with path.open("r+b", buffering=0) as file:
        size = file.seek(0, os.SEEK_END)
        journal = read_journal(file.fileno(), size)
        if journal is not None:
            for start, new in journal.patches:
                file.seek(start)
                write_all(file, new)
            size = file.truncate(journal.body)
        seal = read_seal(file.fileno(), size)
        if seal is not None:
            file.truncate(seal.body)


def _packed(patches: Sequence[Patch], body: int) -> bytes:
    data = b"".join(_ENTRY.pack(start, len(new)) + new for start, new in patches)
    return data + _FOOTER.pack(MAGIC, body, len(data), zlib.crc32(data))
