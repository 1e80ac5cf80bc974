"""The checksum of what a file holds from its start on, for files that were never finished.

It is the CRC-32 sum of all attributes and all datasets of fixed length but those that change
while a file is written. Names, units and the scenario are among them.
"""

from __future__ import annotations

import zlib
from typing import Any

import h5py
import numpy as np

from vehicledyn.results.hdf5.opening import OpenFile
from vehicledyn.results.hdf5.seal import DamagedError
from vehicledyn.results.hdf5.text_lengths import require_lengths

_ATTRIBUTE = "texts_crc"
_CHANGING = {_ATTRIBUTE, "status", "status_message", "state", "restart/crc"}
_STRUCTURE = {"DIMENSION_LIST", "REFERENCE_LIST", "CLASS", "NAME"}


def write_text_sum(file: h5py.File) -> None:
    """Write the checksum; all that it covers must be there."""
    file.attrs[_ATTRIBUTE] = np.uint32(_sum(file))


def check_texts(file: OpenFile, *, is_finished: bool) -> None:
    """Raise DamagedError unless texts are as they were written; files without a sum pass.

    What a finished file gained at its end is not in the sum: there texts need only be texts.
    """
    found = _sum(file)
    if not is_finished and _ATTRIBUTE in file.attrs and found != int(file.attrs[_ATTRIBUTE]):
        raise DamagedError("wrong checksum of its names, texts or axes")


def _sum(file: h5py.File) -> int:
    sums: list[int] = [_sum_of_attributes("", file)]

    def add(name: str, item: Any) -> None:
        sums.append(_sum_of_attributes(name, item))
        if isinstance(item, h5py.Dataset) and _is_fixed(name, item):
            if isinstance(file, OpenFile):
                require_lengths(file, name, item)
            sums.append(zlib.crc32(_plain(item[()]), zlib.crc32(name.encode())))

    file.visititems(add)
    return zlib.crc32(np.array(sorted(sums), dtype="<u4").tobytes())


def _sum_of_attributes(name: str, item: h5py.Group | h5py.Dataset) -> int:
    found = zlib.crc32(name.encode())
    for key in sorted(item.attrs):
        if key not in _CHANGING and key not in _STRUCTURE:
            found = zlib.crc32(_plain(item.attrs[key]), zlib.crc32(key.encode(), found))
    return found


def _is_fixed(name: str, item: h5py.Dataset) -> bool:
    return item.dtype.kind in "OSfiu" and item.chunks is None and name not in _CHANGING


def _plain(value: Any) -> bytes:
    if isinstance(value, str):
        try:
            return value.encode("utf-8")
        except UnicodeEncodeError:
            raise DamagedError("a text that is no UTF-8") from None
    if isinstance(value, bytes):
        return value
    array = np.asarray(value)
    if array.dtype.kind != "O":
        return array.tobytes()
    return b"\0".join(_plain(item) for item in array.ravel())
