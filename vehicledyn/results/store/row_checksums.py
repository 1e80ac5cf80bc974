"""Checksums of samples: one of every column and block of rows, written with the block.

They find wrong samples in a file that was never finished, and in a copy that another program
made. A row of ``/checksums/crc`` holds the CRC-32 sums of one block: of its times, of each
channel in the order of the file, and of its states if there are any; ``/checksums/row`` holds
the number of rows up to its end.
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence

import h5py
import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.hdf5.seal import DamagedError
from vehicledyn.results.store.layout import CHECKSUMS, dataset_path

_MOST_BLOCKS = 64  # in a chunk
_PORTION = 1 << 20  # bytes


class RowSums:
    """The growing datasets of the checksums while a result is written."""

    def __init__(self, file: h5py.File, columns: int, expected_blocks: int) -> None:
        group = file.create_group(CHECKSUMS)
        rows = min(max(expected_blocks, 1), _MOST_BLOCKS)
        column = group.create_dataset("column", data=np.arange(columns))
        column.make_scale("column")
        self._row = group.create_dataset("row", (0,), "i8", maxshape=(None,), chunks=(rows,))
        self._row.make_scale("row")
        self._crc = group.create_dataset(
            "crc", (0, columns), "u4", maxshape=(None, columns), chunks=(rows, columns)
        )
        for axis, scale in enumerate((self._row, column)):
            self._crc.dims[axis].attach_scale(scale)
        self._row.attrs["long_name"] = "Samples up to the end of the block"
        self._crc.attrs["long_name"] = "CRC-32 of times, channels and states of the block"

    def extend(self, stop: int, columns: Sequence[NDArray[np.float64]]) -> None:
        """Add the checksums of a block whose last row is the one before ``stop``."""
        number = len(self._row)
        self._row.resize(number + 1, axis=0)
        self._crc.resize(number + 1, axis=0)
        self._crc[number] = [zlib.crc32(np.ascontiguousarray(values).data) for values in columns]
        self._row[number] = stop


def check_rows(file: h5py.File, column: int, dataset: h5py.Dataset, length: int) -> None:
    """Compare the first rows of a column with their checksums.

    Parameters
    ----------
    file
        The file; one without checksums passes.
    column
        Number of the column: 0 is the time, -1 the states.
    dataset
        The column, shape (n_times, ...).
    length
        How many rows count.

    Raises
    ------
    DamagedError
        If a block is not as it was written; its offsets are numbers of rows.
    """
    if CHECKSUMS not in file:
        return
    group = file[CHECKSUMS]
    count = min(len(group["row"]), len(group["crc"]))
    first = 0
    for stop, expected in zip(group["row"][:count], group["crc"][:count, column], strict=True):
        if stop > length:
            break
        if stop < first or _sum(dataset, first, int(stop)) != expected:
            raise DamagedError("wrong checksum", first, int(stop))
        first = int(stop)


def cut_samples(file: h5py.File, samples: int) -> None:
    """Cut off what a full disk kept from being a whole sample."""
    group, names = file[CHECKSUMS], file.attrs["channels"]
    count = int(np.searchsorted(group["row"][()], samples, side="right"))
    columns = [file[dataset_path(str(name))] for name in ("time", *names)]
    if "value" in file["states"]:
        columns.append(file["states/value"])
    lengths = [(dataset, samples) for dataset in columns]
    for dataset, length in (*lengths, (group["row"], count), (group["crc"], count)):
        if dataset.shape[0] > length:
            dataset.resize(length, axis=0)


def _sum(dataset: h5py.Dataset, first: int, stop: int) -> int:
    width = dataset.dtype.itemsize * int(np.prod(dataset.shape[1:], dtype=int))
    portion, found = max(1, _PORTION // max(width, 1)), 0
    for start in range(first, stop, portion):
        found = zlib.crc32(
            np.ascontiguousarray(dataset[start : min(start + portion, stop)]).data, found
        )
    return found
