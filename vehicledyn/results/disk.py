"""An HDF5 file that may be written to on a disk that fills up.

HDF5 does not survive a failed write: it tries again when objects are closed, and again when
the process ends, where it crashes. Here the first failure is kept for the caller to ask for
and later writes are dropped, so that the disk holds what a kill at that instant would leave.
"""

from __future__ import annotations

import os
from pathlib import Path

import h5py

from vehicledyn.results import superblock

LIBRARY_VERSIONS = ("v110", "v110")  # newest bounds that common HDF5 1.10 tools read


class Container:
    """An HDF5 file open for writing, whose flush and close tell of every failed write.

    Parameters
    ----------
    path
        File on the disk.
    new
        Whether to make a new file, or to change one that exists.

    Raises
    ------
    OSError
        If it cannot be opened; from :meth:`flush` and :meth:`close`, if a write failed.
    """

    def __init__(self, path: Path, *, new: bool) -> None:
        self._disk = _SteadyFile(path, new=new)
        self.file = h5py.File(
            self._disk, "w" if new else "r+", libver=LIBRARY_VERSIONS, track_order=new
        )

    @property
    def failure(self) -> OSError | None:
        """The first failed write, if any."""
        return self._disk.error

    def flush(self) -> None:
        """Hand everything to the system."""
        self.file.flush()
        self._check()

    def close(self) -> None:
        """Close the file."""
        try:
            self.file.close()
        finally:
            self._disk.close()
        self._check()

    def _check(self) -> None:
        if self.failure is not None:
            raise self.failure


class _SteadyFile:
    """File object for h5py's ``fileobj`` driver; see the module's text."""

    def __init__(self, path: Path, *, new: bool) -> None:
        self._file = path.open("w+b" if new else "r+b", buffering=0)
        self.error: OSError | None = None

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Move to an offset and return it."""
        return self._file.seek(offset, whence)

    def tell(self) -> int:
        """Return the offset."""
        return self._file.tell()

    def read(self, size: int = -1) -> bytes:
        """Return bytes; h5py tells a file object by this method."""
        return self._file.read(size) or b""

    def readinto(self, buffer: bytearray | memoryview) -> int:
        """Fill the buffer and return how many bytes there were."""
        return self._file.readinto(buffer) or 0

    def write(self, data: bytes | memoryview) -> int:
        """Write all bytes, unless a write failed before."""
        rest = memoryview(data)
        if self.tell() == 0 and superblock.is_open_with_readers(bytes(rest[: superblock.SIZE])):
            start = superblock.with_writing_flag(bytes(rest[: superblock.SIZE]))
            rest = memoryview(start + bytes(rest[superblock.SIZE :]))
        try:
            while rest and self.error is None:
                rest = rest[self._file.write(rest) or 0 :]
        except OSError as error:
            self.error = error
        return len(data)

    def truncate(self, size: int) -> int:
        """Set the size of the file, unless a write failed before."""
        try:
            if self.error is None:
                self._file.truncate(size)
        except OSError as error:
            self.error = error
        return size

    def flush(self) -> None:
        """Do nothing: writes are not buffered."""

    def close(self) -> None:
        """Close the file."""
        self._file.close()
