"""A file of intermediate results beside an output, with which a killed computation goes on.

Records are only ever appended, each with its key, length and checksum, so that a kill at any
moment costs at most the last one. A computation that is made again asks for each result by a key
made from all that it depends on; what is not found is computed.
"""

from __future__ import annotations

import logging
import os
import struct
import threading
import zlib
from pathlib import Path
from typing import BinaryIO

from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError
from vehicledyn.results.hdf5.output import write_failed
from vehicledyn.results.hdf5.seal import write_all

KEY_BYTES = 32
"""Length of a key."""

LARGEST = 2**30
"""Size from which on no more results are kept [bytes]; a resumed computation makes them again."""

_MAGIC = b"vehicledyn-checkpoint 1\n"
_HEAD = struct.Struct(f"<{KEY_BYTES}sQI")

_log = logging.getLogger(__name__)


def checkpoint_path(output: Path) -> Path:
    """Return the checkpoint's name of an output."""
    return output.with_name(f"{output.name}.checkpoint")


class Checkpoint:
    """Intermediate results of one computation on one output; threads may use them at once.

    Nothing is written before the first result.

    Parameters
    ----------
    output
        The output that it belongs to.
    identity
        What the computation depends on; results of another identity are refused.
    resume
        Whether to go on with results that an earlier computation left.

    Attributes
    ----------
    n_known
        How many results it left.

    Raises
    ------
    InputError
        If the file cannot be read or written, or belongs to another computation.
    """

    def __init__(self, output: Path, identity: str, *, resume: bool) -> None:
        self.path = checkpoint_path(output)
        self._places: dict[bytes, tuple[int, int]] = {}
        self._begin = _MAGIC + identity.encode() + b"\n"
        self._file: BinaryIO | None = None
        self._is_full, self._lock = False, threading.Lock()
        if self.path.exists() and not self.path.is_file():
            raise InputError(
                f"{self.path}: is not a regular file; remove it or choose another output"
            )
        try:
            if not resume:
                self.path.unlink(missing_ok=True)
            elif self.path.exists() and self.path.stat().st_size >= len(self._begin):
                self._file = self.path.open("r+b", buffering=0)
                self._read(self._file)
        except BaseException as error:
            self.close()
            if isinstance(error, OSError):
                raise write_failed(self.path, error) from error
            raise
        self.n_known = len(self._places)

    @property
    def is_recalling(self) -> bool:
        """Whether all results so far were made by an earlier computation."""
        return self.n_known > 0 and len(self._places) == self.n_known

    def get(self, key: bytes) -> bytes | None:
        """Return the result of a key, None where there is none."""
        with self._lock:
            place = self._places.get(key)
            if place is None or self._file is None:
                return None
            self._file.seek(place[0])
            return self._file.read(place[1])

    def put(self, key: bytes, data: bytes) -> None:
        """Keep a result; where it cannot be written, on a full disk, no more are kept."""
        with self._lock:
            if not self._is_full:
                self._put(key, data)

    @staticmethod
    def _record(key: bytes, data: bytes) -> bytes:
        return _HEAD.pack(key, len(data), zlib.crc32(data, zlib.crc32(key))) + data

    def _put(self, key: bytes, data: bytes) -> None:
        begin = 0
        try:
            if self._file is None:
                self._file = self.path.open("w+b", buffering=0)
                write_all(self._file, self._begin)
            begin = self._file.seek(0, os.SEEK_END)
            if begin + len(data) > LARGEST:
                self._is_full = True
                return
            write_all(self._file, self._record(key, data))
        except OSError:
            self._is_full = True
            if self._file is not None:
                self._file.truncate(begin)
            return
        self._places[key] = begin + _HEAD.size, len(data)

    def close(self) -> None:
        """Leave the results to a later computation."""
        if self._file is not None:
            self._file.close()

    def remove(self) -> None:
        """Remove them, as the computation is complete."""
        self.close()
        self.path.unlink(missing_ok=True)

    def _read(self, file: BinaryIO) -> None:
        """Note where results are; cut off what a kill has left of the last one."""
        if file.read(len(self._begin)) != self._begin:
            raise InputError(
                f"{self.path}: belongs to another computation: the model, the options or the "
                f"version of the program differ; start again without {argument('resume')}, "
                "or undo the change"
            )
        end, size = len(self._begin), self.path.stat().st_size
        while end + _HEAD.size <= size:
            key, length, wanted = _HEAD.unpack(file.read(_HEAD.size))
            if end + _HEAD.size + length > size:
                break
            data = file.read(length)
            if zlib.crc32(data, zlib.crc32(key)) != wanted:
                _log.warning("%s: is damaged; what lies behind is computed again", self.path)
                break
            self._places[key] = end + _HEAD.size, length
            end += _HEAD.size + length
        file.truncate(end)
