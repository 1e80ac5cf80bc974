"""Whether the columns of a result file can be what a run wrote, before they are read."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.results.store.decimation import promises_too_much
from vehicledyn.results.store.layout import FORMAT, FORMAT_VERSION, dataset_path


def check_format(path: Path, file: h5py.File) -> None:
    """Refuse files of other programs, and results of a newer format than this program reads."""
    if str(file.attrs.get("format", "")) != FORMAT:
        raise InputError(f"{path}: is HDF5, but not a result of this program")
    version = int(file.attrs["format_version"])
    if version > FORMAT_VERSION:
        raise InputError(
            f"{path}: has format version {version}, this program reads up to "
            f"{FORMAT_VERSION}; update vehicledyn"
        )


def check_lengths(path: Path, lengths: Mapping[str, int], *, closed: bool) -> None:
    """Refuse channels that are shorter than the time, or longer though the file is closed."""
    samples = lengths["time"]
    for name, length in lengths.items():
        if length < samples or (closed and length != samples):
            raise InputError(
                f"{path}: is damaged: {length} samples of {name}, but {samples} of time; "
                "run it again"
            )


def check_times(path: Path, blocks: Iterable[NDArray[np.float64]], *, closed: bool) -> None:
    """Refuse times [s], block by block, that are no numbers or, in a closed file, fall."""
    start, last = 0, -np.inf
    for time in blocks:
        wrong = ~np.isfinite(time)
        if closed:
            wrong |= time < np.concatenate([[last], time[:-1]])
        if wrong.any():
            place = int(np.argmax(wrong))
            raise InputError(
                f"{path}: is damaged: its time number {start + place + 1} is {time[place]:.6g}, "
                "which does not follow the one before; run it again"
            )
        start, last = start + len(time), float(time[-1])


def refuse_promises(path: Path, file: h5py.File, names: Sequence[str]) -> dict[str, int]:
    """Refuse what are no columns, or say to hold far more than they do, before reading.

    Returns
    -------
    dict
        Length of the time and of each channel.
    """
    lengths = {}
    for name in ("time", *names):
        column = file[dataset_path(name)]
        if len(column.shape) != 1 or column.dtype.kind not in "fiu":
            raise InputError(f"{path}: is damaged: {name} is no column of numbers")
        if promises_too_much(column):
            raise InputError(
                f"{path}: is damaged: says to hold {column.shape[0]} samples, but they are not in "
                "the file; run it again"
            )
        lengths[name] = int(column.shape[0])
    return lengths
