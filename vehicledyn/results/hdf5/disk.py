"""An HDF5 file that may be written to on a disk that fills up.

HDF5 does not survive a failed write: it tries again when objects are closed, and again when
the process ends, where it crashes. Here the first failure is kept for the caller to ask for and
later writes stay in memory, where HDF5 finds them again. So HDF5 ends its work in peace, and
the disk holds what a kill at that instant would leave.
"""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

import h5py

from vehicledyn.results.hdf5 import superblock

LIBRARY_VERSIONS = ("v110", "v110")  # newest bounds that common HDF5 1.10 tools read


class Container:
    """An HDF5 file open for writing, whose flush and close report every failed write.

    Parameters
    ----------
    path
        File on the disk.
    new
        Whether to make a new file, or to change one that exists.
    cache
        Memory for the chunks of each dataset [bytes]; HDF5's own choice times some hundred
        channels is more than a gigabyte.

    Raises
    ------
    OSError
        If it cannot be opened; from :meth:`flush` and :meth:`close`, if a write failed.
    """

    def __init__(self, path: Path, *, new: bool, cache: int = 1 << 23) -> None:
        self._disk = _SteadyFile(path, new=new)
        self.file = h5py.File(
            self._disk,
            "w" if new else "r+",
            libver=LIBRARY_VERSIONS,
            track_order=new,
            rdcc_nbytes=cache,
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

    def abandon(self) -> None:
        """Close the file without writing to the disk, which holds what was flushed."""
        self._disk.detach()
        with contextlib.suppress(OSError, RuntimeError):
            self.file.close()
        self._disk.close()

    def _check(self) -> None:
        if self.failure is not None:
            raise self.failure


class _SteadyFile:
    """File object for h5py's ``fileobj`` driver; see the module's text."""

    def __init__(self, path: Path, *, new: bool) -> None:
        self._file = path.open("w+b" if new else "r+b", buffering=0)
        self.error: OSError | None = None
        self._kept: list[tuple[int, bytes]] = []
        self._detached = False

    def detach(self) -> None:
        """Keep in memory what is written from now on."""
        self._detached = True

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Move to an offset and return it."""
        return self._file.seek(offset, whence)

    def tell(self) -> int:
        """Return the offset."""
        return self._file.tell()

    def read(self, size: int = -1) -> bytes:
        """Return bytes; h5py recognises a file object by this method."""
        return self._file.read(size) or b""

    def readinto(self, buffer: bytearray | memoryview) -> int:
        """Fill the buffer and return how many bytes there were."""
        start = self.tell()
        count = self._file.readinto(buffer) or 0
        if self._reaches_disk:
            return count
        view = memoryview(buffer).cast("B")
        view[count:] = bytes(len(view) - count)
        for offset, data in self._kept:
            first, last = max(offset, start), min(offset + len(data), start + len(view))
            if first < last:
                view[first - start : last - start] = data[first - offset : last - offset]
        return len(view)

    def write(self, data: bytes | memoryview) -> int:
        """Write all bytes, or keep them in memory once a write has failed."""
        start, rest = self.tell(), memoryview(bytes(data))
        if start == 0 and superblock.is_open_with_readers(bytes(rest[: superblock.SIZE])):
            first = superblock.with_writing_flag(bytes(rest[: superblock.SIZE]))
            rest = memoryview(first + bytes(rest[superblock.SIZE :]))
        whole = bytes(rest)
        try:
            while rest and self._reaches_disk:
                rest = rest[self._file.write(rest) or 0 :]
        except OSError as error:
            self.error = error
        if not self._reaches_disk:
            self._kept.append((start, whole))
        return len(data)

    def truncate(self, size: int) -> int:
        """Set the size of the file, unless a write has failed."""
        try:
            if self._reaches_disk:
                self._file.truncate(size)
        except OSError as error:
            self.error = error
        return size

    def flush(self) -> None:
        """Do nothing: writes are not buffered."""

    def close(self) -> None:
        """Close the file."""
        self._file.close()

    @property
    def _reaches_disk(self) -> bool:
        return self.error is None and not self._detached
