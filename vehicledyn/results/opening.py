"""Opening an HDF5 file for reading, whatever was left of it.

A file that a living process writes is opened as its reader. One that a killed run left is
opened as if it had been closed: a reader of such a file would wait for a writer to repair what
is damaged, for minutes.
"""

from __future__ import annotations

import os
from pathlib import Path

import h5py

from vehicledyn.base.errors import InputError
from vehicledyn.base.files import open_regular
from vehicledyn.results import superblock
from vehicledyn.results.output import is_being_written


def open_file(path: Path) -> h5py.File:
    """Open a file for reading.

    Raises
    ------
    InputError
        If there is no such file, it is no regular file, or it is not HDF5 or cut off.
    OSError
        If it is damaged otherwise.
    """
    if not is_concurrent(path):
        return h5py.File(path, "r")
    if is_being_written(path.resolve()):
        return h5py.File(path, "r", swmr=True)
    return h5py.File(_LeftFile(path), "r")


def is_concurrent(path: Path) -> bool:
    """Return whether the file was opened for writing with readers and never closed.

    Raises
    ------
    InputError
        If there is no such file, or it is not HDF5 or cut off.
    """
    with open_regular(path) as file:
        start, size = file.read(superblock.SIZE), os.fstat(file.fileno()).st_size
    if not start.startswith(superblock.SIGNATURE):
        raise InputError(f"{path}: is not an HDF5 file; give a result of 'vehicledyn run'")
    if not superblock.is_open_with_readers(start):
        return False
    if len(start) < superblock.SIZE or superblock.end_of(start) > size:
        raise InputError(f"{path}: is damaged (its end is missing); run it again")
    return True


class _LeftFile:
    """File object for h5py of a file that was never closed, its first bytes as if it had been."""

    def __init__(self, path: Path) -> None:
        self._number = os.open(path, os.O_RDONLY | getattr(os, "O_BINARY", 0))
        self._size = os.fstat(self._number).st_size
        self._start = superblock.as_closed(self._bytes(superblock.SIZE, 0), self._size)
        self._place = 0

    def __del__(self) -> None:
        """Close the file with the last reference, which HDF5 has."""
        if hasattr(self, "_number"):
            os.close(self._number)

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
        data = self._bytes(max(count, 0), self._place)
        if self._place < superblock.SIZE:
            head = self._start[self._place : self._place + len(data)]
            data = head + data[len(head) :]
        self._place += len(data)
        return data

    def readinto(self, buffer: bytearray | memoryview) -> int:
        """Fill the buffer and return how many bytes there were."""
        view = memoryview(buffer).cast("B")
        data = self.read(len(view))
        view[: len(data)] = data
        return len(data)

    def _bytes(self, count: int, offset: int) -> bytes:
        os.lseek(self._number, offset, os.SEEK_SET)
        parts = []
        while count > 0 and (part := os.read(self._number, count)):
            parts.append(part)
            count -= len(part)
        return b"".join(parts)
