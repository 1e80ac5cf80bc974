"""Opening an HDF5 file for reading, whatever was left of it.

A file that a living process writes is opened as its reader. One that a killed run left is
opened as if it had been closed: a reader of such a file would wait for a writer to repair what
is damaged, for minutes.
"""

from __future__ import annotations

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.limits import open_regular
from vehicledyn.results.hdf5 import superblock
from vehicledyn.results.hdf5.guard import GuardedFile
from vehicledyn.results.hdf5.output import is_being_written
from vehicledyn.results.hdf5.seal import DamagedError


class OpenFile(h5py.File):  # type: ignore[misc]
    """An HDF5 file open for reading whose damage is noticed.

    Attributes
    ----------
    guard
        What checks the bytes; None for a file that a living process writes.
    is_finished
        Whether the writer has closed it.
    """

    guard: GuardedFile | None
    is_finished: bool

    def check(self) -> None:
        """Raise DamagedError if bytes that were read are not those that were written."""
        if self.guard is not None:
            self.guard.check()


def open_file(path: Path) -> OpenFile:
    """Open a file for reading.

    Raises
    ------
    InputError
        If there is no such file, it is no regular file, or it is not HDF5 or cut off.
    OSError
        If it is damaged otherwise.
    """
    if is_open_for_writing(path) and is_being_written(path.resolve()):
        file = OpenFile(path, "r", swmr=True)
        file.guard, file.is_finished = None, False
        return file
    guard = GuardedFile(path)
    try:
        file = OpenFile(guard, "r", rdcc_nbytes=1 << 20)
    except (OSError, RuntimeError) as error:
        raise _cause(guard, error) from error
    file.guard, file.is_finished = guard, guard.is_finished
    return file


def is_open_for_writing(path: Path) -> bool:
    """Return whether the file was opened for writing with readers and never closed.

    Raises
    ------
    InputError
        If there is no such file, or it is not HDF5 or cut off.
    """
    with open_regular(path) as file:
        start, size = file.read(superblock.SIZE) or b"", os.fstat(file.fileno()).st_size
    if not start.startswith(superblock.SIGNATURE):
        raise InputError(f"{path}: is not an HDF5 file; give a result of 'vehicledyn run'")
    if not superblock.is_open_with_readers(start):
        return False
    if len(start) < superblock.SIZE or superblock.end_of(start) > size:
        raise InputError(f"{path}: is damaged (its end is missing); run it again")
    return True


@contextlib.contextmanager
def noticing_damage(file: Any) -> Iterator[None]:
    """Raise DamagedError for damage that was read meanwhile, also where HDF5 saw nothing.

    What HDF5 complains of is explained by damage that was found before, if there is any.
    """
    guard = getattr(file, "guard", None)
    if guard is None:
        yield
        return
    try:
        yield
    except Exception as error:
        cause = _cause(guard, error)
        if cause is error:
            raise
        raise cause from error
    guard.check()


def _cause(guard: GuardedFile, error: Exception) -> Exception:
    try:
        guard.check()
    except DamagedError as damage:
        return damage
    return guard.suspicion or error
