"""A file object for h5py that hands on no byte which is known to be wrong.

HDF5 must not see an exception of its file object, so damage is noted, bytes without meaning are
handed on, and :meth:`GuardedFile.check` raises what was found. The bytes of sealed files are
checked against their seal; in others HDF5 checks its structure, and what it does not check is
checked here.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from vehicledyn.results.hdf5 import superblock
from vehicledyn.results.hdf5.heaps import HEAD, SIGNATURE, check_heap, heaps_in
from vehicledyn.results.hdf5.journal import Journal, read_journal
from vehicledyn.results.hdf5.seal import DamagedError, Patch, patched, read_seal

_FILLING = b"\xff"
"""Stands for damaged bytes: not a number, no signature, and an end to any list of HDF5."""
_FIRST_LETTER = SIGNATURE[:1]
_NO_FLAG = getattr(os, "O_BINARY", 0)


class GuardedFile:
    """An HDF5 file for reading: finished and sealed, finished by others, or left by a kill.

    Parameters
    ----------
    path
        File on the disk.

    Raises
    ------
    OSError
        If it cannot be opened, or its checksums are damaged themselves.
    """

    def __init__(self, path: Path) -> None:
        self._number = os.open(path, os.O_RDONLY | _NO_FLAG)
        size = os.fstat(self._number).st_size
        journal = read_journal(self._number, size)
        self._seal = read_seal(self._number, size)
        self._size = size
        self._patches = self._first_patches(journal, size)
        if self._seal is not None:
            self._size = self._seal.body
        self.is_finished = not self._was_left
        """Whether the writer closed the file."""
        self._place = 0
        self._good: set[int] = set()
        self._heaps: dict[int, DamagedError | None] = {}
        self._hidden: list[Patch] = []
        self._damage: DamagedError | None = None
        self.suspicion: DamagedError | None = None
        """A broken heap that was passed over: what HDF5 complains of next may be due to it."""

    def __del__(self) -> None:
        """Close the file with the last reference, which HDF5 has."""
        if hasattr(self, "_number"):
            os.close(self._number)

    @property
    def size(self) -> int:
        """Bytes that HDF5 sees."""
        return self._size

    @property
    def is_sealed(self) -> bool:
        """Whether every byte is checked."""
        return self._seal is not None

    def check(self) -> None:
        """Raise the damage that was read, if any, once."""
        found, self._damage = self._damage, None
        if found is not None:
            raise found

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Move to an offset and return it."""
        base = {os.SEEK_SET: 0, os.SEEK_CUR: self._place, os.SEEK_END: self._size}[whence]
        self._place = base + offset
        return self._place

    def tell(self) -> int:
        """Return the offset."""
        return self._place

    def read(self, size: int = -1) -> bytes:
        """Return bytes from the offset on."""
        count = self._size - self._place if size < 0 else size
        data = bytearray(max(count, 0))
        return bytes(data[: self.readinto(data)])

    def readinto(self, buffer: bytearray | memoryview) -> int:
        """Fill the buffer and return how many bytes there were."""
        view, start = memoryview(buffer).cast("B"), self._place
        count = self._fill(view[: max(0, self._size - start)], start)
        data = view[:count]
        try:
            self._verify(start, start + count)
        except DamagedError as error:
            self._damage = self._damage or error
            data[:] = _FILLING * count
        if self._seal is None:
            self._hide_broken_heaps(data, start)
        self._place += count
        return count

    def _first_patches(self, journal: Journal | None, size: int) -> Sequence[Patch]:
        patches = () if journal is None else journal.patches
        start = bytearray(os.pread(self._number, superblock.SIZE, 0))
        patched(start, 0, patches)
        self._was_left = superblock.is_open_with_readers(bytes(start))
        if not self._was_left:
            if self._seal is None and journal is None and superblock.has_tail(bytes(start), size):
                raise DamagedError("its checksums are missing")
            return patches
        return (*patches, (0, superblock.as_closed(bytes(start), size)))

    def _verify(self, start: int, stop: int) -> None:
        """Check the blocks that some bytes lie in, each once."""
        if self._seal is None:
            return
        for number in self._seal.blocks(start, stop):
            if number not in self._good:
                first, last = self._seal.block(number)
                self._seal.check(number, self.bytes_at(first, last - first))
                self._good.add(number)

    def _hide_broken_heaps(self, data: memoryview, start: int) -> None:
        known = bytes(data)
        if _FIRST_LETTER in known[1 - HEAD.size :]:
            known += self.bytes_at(start + len(data), HEAD.size - 1)
        for heap in heaps_in(known, start):
            if heap not in self._heaps:
                self._heaps[heap] = self._broken(heap)
                if self._heaps[heap] is not None:
                    self._hidden.append((heap, bytes(HEAD.size)))
            self.suspicion = self.suspicion or self._heaps[heap]
        patched(data, start, self._hidden)

    def _broken(self, heap: int) -> DamagedError | None:
        def read(count: int, offset: int) -> bytes:
            self._verify(offset, offset + count)
            return self.bytes_at(offset, count)

        try:
            check_heap(read, heap, self._size)
        except DamagedError as error:
            return error
        return None

    def bytes_at(self, offset: int, count: int) -> bytes:
        """Return unchecked bytes from an offset on, as many as there are."""
        data = bytearray(max(0, min(count, self._size - offset)))
        return bytes(data[: self._fill(memoryview(data), offset)])

    def _fill(self, view: memoryview, offset: int) -> int:
        """Fill a buffer from an offset on; return how many bytes there were."""
        done = 0
        while done < len(view):
            count = os.preadv(self._number, [view[done:]], offset + done)
            if not count:
                break
            done += count
        patched(view[:done], offset, self._patches)
        return done
