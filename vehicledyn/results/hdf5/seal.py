"""Checksums of every byte of a finished file, kept behind the end that HDF5 knows.

HDF5 protects most of its own structure, but neither values nor its heaps of texts. A finished
file therefore ends in CRC-32 sums of its blocks. Programs that know nothing of them read
the file as before; one that changes it cuts them off.
"""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import IO, TypeAlias

Patch: TypeAlias = tuple[int, bytes]
"""Offset and the bytes that belong there."""

BLOCK = 1 << 14  # bytes
MAGIC = b"\x89VDSEAL\n"

_FOOTER = struct.Struct("<8sIIQI")
SIZE = _FOOTER.size + 4
"""Bytes of the footer, with its own checksum."""


class DamagedError(OSError):
    """Bytes of a file are not those that were written.

    ``first`` and ``last`` are the offsets of the damaged block [bytes]; ``last`` is excluded.
    """

    def __init__(self, text: str, first: int = 0, last: int = 0) -> None:
        super().__init__(text)
        self.first, self.last = first, last


@dataclass(frozen=True)
class Seal:
    """Checksums of the blocks of the first ``body`` bytes of a file."""

    body: int
    sums: tuple[int, ...]

    def block(self, number: int) -> tuple[int, int]:
        """Return where a block begins and ends [bytes]."""
        return number * BLOCK, min((number + 1) * BLOCK, self.body)

    def blocks(self, start: int, stop: int) -> range:
        """Return the numbers of the blocks that some bytes of the body lie in."""
        stop = min(stop, self.body)
        return range(start // BLOCK, -(-stop // BLOCK)) if start < stop else range(0)

    def check(self, number: int, data: bytes | memoryview) -> None:
        """Raise DamagedError unless the bytes of a block are those that were sealed."""
        first, last = self.block(number)
        if len(data) != last - first or zlib.crc32(data) != self.sums[number]:
            raise DamagedError(f"wrong checksum of bytes {first} to {last - 1}", first, last)


def seal_of(file: IO[bytes], body: int, patches: Sequence[Patch] = ()) -> bytes:
    """Return the seal of the first ``body`` bytes of a file, some of them replaced by patches.

    Raises
    ------
    OSError
        If the file cannot be read or is too short.
    """
    sums = []
    for start in range(0, body, BLOCK):
        block = bytearray(_read_all(file, start, min(BLOCK, body - start)))
        patched(block, start, patches)
        sums.append(zlib.crc32(block))
    table = struct.pack(f"<{len(sums)}I", *sums)
    head = _FOOTER.pack(MAGIC, 1, BLOCK, body, zlib.crc32(table))
    return table + head + struct.pack("<I", zlib.crc32(head))


def seal(path: Path) -> None:
    """Append the seal to a file that is whole but does not have its name yet."""
    with path.open("r+b", buffering=0) as file:
        body = file.seek(0, os.SEEK_END)
        found = seal_of(file, body)
        file.seek(body)
        write_all(file, found)


def read_seal(number: int, size: int) -> Seal | None:
    """Return the seal of an open file (its descriptor) of a size, None if it has none.

    Raises
    ------
    DamagedError
        If there is a seal that is damaged itself.
    """
    footer = os.pread(number, SIZE, max(0, size - SIZE))
    if len(footer) < SIZE or not footer.startswith(MAGIC):
        return None
    head = footer[: _FOOTER.size]
    if struct.unpack("<I", footer[_FOOTER.size :])[0] != zlib.crc32(head):
        raise DamagedError("its checksums are damaged")
    _, version, block, body, crc = _FOOTER.unpack(head)
    count = -(-body // BLOCK)
    if version != 1 or block != BLOCK or body + 4 * count + SIZE != size:
        raise DamagedError("its checksums do not fit its size")
    table = os.pread(number, 4 * count, body)
    if len(table) != 4 * count or zlib.crc32(table) != crc:
        raise DamagedError("its checksums are damaged")
    return Seal(body, struct.unpack(f"<{count}I", table))


def write_all(file: IO[bytes], data: bytes) -> None:
    """Write bytes to an unbuffered file, however many parts the system takes them in."""
    rest = memoryview(data)
    while rest:
        rest = rest[file.write(rest) or 0 :]


def patched(data: bytearray | memoryview, offset: int, patches: Sequence[Patch]) -> None:
    """Replace what patches change in bytes that begin at an offset of the file."""
    for start, new in patches:
        first, last = max(start, offset), min(start + len(new), offset + len(data))
        if first < last:
            data[first - offset : last - offset] = new[first - start : last - start]


def _read_all(file: IO[bytes], start: int, count: int) -> bytes:
    file.seek(start)
    parts = []
    while count and (part := file.read(count)):
        parts.append(part)
        count -= len(part)
    if count:
        raise DamagedError("the file ends too soon", start, start + count)
    return b"".join(parts)
