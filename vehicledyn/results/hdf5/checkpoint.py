"""A file of intermediate results beside an output, with which a killed computation goes on.

Records are only ever appended, each with its key, length and checksum, so that a kill at any
moment costs at most the last one. A computation that is made again asks for each result by a key
made from all that it depends on; what is not found is computed.
"""

from __future__ import annotations

import os
import struct
import zlib
from pathlib import Path
from typing import BinaryIO

from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError
from vehicledyn.results.hdf5.output import write_failed

KEY_BYTES = 32
"""Length of a key."""

LARGEST = 2**30
"""Size from which on no more results are kept [bytes]; a resumed computation makes them again."""

_MAGIC = b"vehicledyn-checkpoint 1\n"
_HEAD = struct.Struct(f"<{KEY_BYTES}sQI")


def checkpoint_path(output: Path) -> Path:
    """Return the checkpoint's name of an output."""
    return output.with_name(f"{output.name}.checkpoint")


class Checkpoint:
    """Intermediate results of one computation on one output.

    Parameters
    ----------
    output
        The output that it belongs to.
    identity
        What the computation depends on; results of another identity are refused.
    resume
        Whether to go on with results that an earlier computation left.

    Raises
    ------
    InputError
        If the file cannot be read or written, or belongs to another computation.
    """

    def __init__(self, output: Path, identity: str, *, resume: bool) -> None:
        self.path = checkpoint_path(output)
        self._places: dict[bytes, tuple[int, int]] = {}
        self._is_full = False
        begin = _MAGIC + identity.encode() + b"\n"
        if self.path.exists() and not self.path.is_file():
            raise InputError(
                f"{self.path}: is not a regular file; remove it or choose another output"
            )
        going_on = resume and self.path.exists() and self.path.stat().st_size >= len(begin)
        try:
            self._file: BinaryIO = self.path.open("r+b" if going_on else "w+b", buffering=0)
        except OSError as error:
            raise write_failed(self.path, error) from error
        try:
            if going_on:
                self._read(begin)
            else:
                self._file.write(begin)
        except BaseException as error:
            self._file.close()
            if isinstance(error, OSError):
                raise write_failed(self.path, error) from error
            raise
        self._known = len(self._places)

    @property
    def is_recalling(self) -> bool:
        """Whether all results so far were made by an earlier computation."""
        return self._known > 0 and len(self._places) == self._known

    def get(self, key: bytes) -> bytes | None:
        """Return the result of a key, None where there is none."""
        place = self._places.get(key)
        if place is None:
            return None
        self._file.seek(place[0])
        return self._file.read(place[1])

    def put(self, key: bytes, data: bytes) -> None:
        """Keep a result; where it cannot be written, on a full disk, no more are kept."""
        if self._is_full:
            return
        head = _HEAD.pack(key, len(data), zlib.crc32(data, zlib.crc32(key)))
        begin = self._file.seek(0, os.SEEK_END)
        try:
            self._is_full = begin + len(data) > LARGEST
            rest = memoryview(b"" if self._is_full else head + data)
            while rest:
                rest = rest[self._file.write(rest) or 0 :]
        except OSError:
            self._is_full = True
            self._file.truncate(begin)
        if self._is_full:
            return
        self._places[key] = begin + len(head), len(data)

    def close(self) -> None:
        """Leave the results to a later computation."""
        self._file.close()

    def remove(self) -> None:
        """Remove them, as the computation is complete."""
        self._file.close()
        self.path.unlink(missing_ok=True)

    def _read(self, begin: bytes) -> None:
        """Note where results are; cut off what a kill has left of the last one."""
        if self._file.read(len(begin)) != begin:
            raise InputError(
                f"{self.path}: belongs to another computation: the model, the options or the "
                f"version of the program differ; start again without {argument('resume')}, "
                "or undo the change"
            )
        end, size = len(begin), self.path.stat().st_size
        while end + _HEAD.size <= size:
            key, length, wanted = _HEAD.unpack(self._file.read(_HEAD.size))
            if end + _HEAD.size + length > size:
                break
            data = self._file.read(length)
            if zlib.crc32(data, zlib.crc32(key)) != wanted:
                break
            self._places[key] = end + _HEAD.size, length
            end += _HEAD.size + length
        self._file.truncate(end)
