"""The last change of a file that was written sample by sample: in place, at once, and sealed.

The file needs no second copy of itself: HDF5 works on it in memory, and what it wrote is then
committed, see :mod:`vehicledyn.results.hdf5.journal`.
"""

from __future__ import annotations

import errno
import os
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import IO

import h5py

from vehicledyn.results.hdf5 import superblock
from vehicledyn.results.hdf5.disk import LIBRARY_VERSIONS
from vehicledyn.results.hdf5.journal import commit
from vehicledyn.results.hdf5.seal import Patch, patched

RESERVE = 1 << 18  # bytes


def finish(path: Path, change: Callable[[h5py.File], None]) -> None:
    """Change a file that nobody writes any more and seal it; after a failure it is as before.

    Parameters
    ----------
    path
        A file that is open for readers, as a kill leaves it.
    change
        Makes the changes.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    with path.open("r+b", buffering=0) as disk:
        layer = _Layer(disk)
        with h5py.File(layer, "r+", libver=LIBRARY_VERSIONS) as file:
            change(file)
        commit(disk, layer.patches, layer.end)


class Reserve:
    """Space on the disk of an output that is kept for its end; vanishes with the process.

    Raises
    ------
    OSError
        If there is no such space.
    """

    def __init__(self, folder: Path, size: int = RESERVE) -> None:
        self._file: IO[bytes] | None = tempfile.TemporaryFile(dir=folder, buffering=0)  # noqa: SIM115
        try:
            self._file.write(bytes(size))
        except OSError as error:
            self.release()
            # A limit on the size of files is no lack of space.
            if error.errno != errno.EFBIG:
                raise

    def release(self) -> None:
        """Give the space back; doing so twice does nothing."""
        if self._file is not None:
            self._file.close()
            self._file = None


class _Layer:
    """File object for h5py: a file, and what was written over it, which stays in memory."""

    def __init__(self, disk: IO[bytes]) -> None:
        self._disk = disk
        self._size = disk.seek(0, os.SEEK_END)
        self._place = 0
        self.patches: list[Patch] = []
        start = self._bytes(superblock.SIZE, 0)
        if superblock.is_open_with_readers(start):
            self.patches.append((0, superblock.as_closed(start, self._size)))
        self._size = max(self._size, superblock.end_of(start))

    @property
    def end(self) -> int:
        """Where HDF5 says that the changed file ends [bytes]."""
        return superblock.end_of(self._bytes(superblock.SIZE, 0))

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Move to an offset and return it."""
        base = {os.SEEK_SET: 0, os.SEEK_CUR: self._place, os.SEEK_END: self._size}[whence]
        self._place = base + offset
        return self._place

    def tell(self) -> int:
        """Return the offset."""
        return self._place

    def read(self, size: int = -1) -> bytes:
        """Return bytes; h5py recognises a file object by this method."""
        data = self._bytes(self._size - self._place if size < 0 else size, self._place)
        self._place += len(data)
        return data

    def readinto(self, buffer: bytearray | memoryview) -> int:
        """Fill the buffer and return how many bytes there were."""
        view = memoryview(buffer).cast("B")
        data = self.read(len(view))
        view[: len(data)] = data
        return len(data)

    def write(self, data: bytes | memoryview) -> int:
        """Keep bytes in memory."""
        self.patches.append((self._place, bytes(data)))
        self._place += len(data)
        self._size = max(self._size, self._place)
        return len(data)

    def truncate(self, size: int) -> int:
        """Set the size."""
        self._size = size
        return size

    def flush(self) -> None:
        """Do nothing."""

    def _bytes(self, count: int, offset: int) -> bytes:
        count = max(0, min(count, self._size - offset))
        self._disk.seek(offset)
        data = bytearray(count)
        done = 0
        while done < count and (part := self._disk.readinto(memoryview(data)[done:])):  # type: ignore[attr-defined]
            done += part
        patched(data, offset, self.patches)
        return bytes(data)
