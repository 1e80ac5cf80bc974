"""Lengths of stored texts: HDF5 makes room for as much as a text's reference says, and then looks.

References
----------
The HDF Group, HDF5 File Format Specification 3.0, section VIII (variable-length data).
"""

from __future__ import annotations

import h5py
import numpy as np

from vehicledyn.results.hdf5.opening import OpenFile
from vehicledyn.results.hdf5.seal import DamagedError

_REFERENCE = np.dtype([("length", "<u4"), ("heap", "<u8"), ("index", "<u4")])


def require_lengths(file: OpenFile, name: str, item: h5py.Dataset) -> None:
    """Raise DamagedError if texts of a dataset are said to be longer than the file.

    Sealed files and those of a living process are not looked at; every byte of the former is
    checked.
    """
    guard = file.guard
    if guard is None or guard.is_sealed or item.dtype.kind != "O" or item.chunks is not None:
        return
    start, size = item.id.get_offset(), item.id.get_storage_size()
    if start is None or size % _REFERENCE.itemsize:
        return
    lengths = np.frombuffer(guard.bytes_at(start, size), dtype=_REFERENCE)["length"]
    if int(lengths.sum(dtype=np.int64)) > guard.size:
        raise DamagedError(f"texts of {name} that are longer than the file")
