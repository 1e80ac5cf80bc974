"""Checksums of the cases of a study, written with each block of them.

The CRC-32 sum of a case is that of the values of its axes, its end time and reason, its key
figures with their names, and its samples.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.hdf5.seal import DamagedError
from vehicledyn.results.store.decimation import promises_too_much
from vehicledyn.results.store.study_layout import PENDING

DATASET = "cases/crc"

_CASES = 512
AT_ONCE = 1 << 22
"""Samples that are read or written at once [bytes]."""


def sums_in(file: h5py.File, first: int, stop: int) -> NDArray[np.uint32]:
    """Return the checksums of some cases as they are in the file, shape (stop - first,)."""
    rows = slice(first, stop)
    parts: dict[str, Any] = {"names": file["figures/name"][()]}
    names = ("cases/values", "cases/end_time", "cases/reason", "figures/value", "figures/text")
    parts |= {name: file[name][rows] for name in names}
    sums = [_sum(parts, row, _samples(file, first + row)) for row in range(stop - first)]
    return np.array(sums, dtype=np.uint32)


def _samples(file: h5py.File, case: int) -> Iterator[Any]:
    """Yield the samples of a case in parts."""
    if "samples" not in file:
        return
    dataset = file["samples"]
    count, width = dataset.shape[1:]
    step = max(1, AT_ONCE // max(1, width * dataset.dtype.itemsize))
    for first in range(0, count, step):
        yield dataset[case, first : first + step]


def check_cases(file: h5py.File) -> None:
    """Compare all cases that are computed with their checksums; files without any pass.

    Raises
    ------
    DamagedError
        If a case is not as it was written.
    """
    if DATASET not in file:
        return
    for name in ("cases/status", DATASET):
        if promises_too_much(file[name]):
            raise DamagedError(f"{name} is not in the file")
    status, known = file["cases/status"][()], file[DATASET][()]
    for first in range(0, len(status), _CASES):
        stop = min(first + _CASES, len(status))
        if (status[first:stop] == PENDING).all():
            continue
        wrong = sums_in(file, first, stop) != known[first:stop]
        wrong &= status[first:stop] != PENDING
        if wrong.any():
            raise DamagedError(f"wrong checksum of case {first + int(np.argmax(wrong)) + 1}")


def _sum(parts: Mapping[str, Any], row: int, samples: Iterable[Any]) -> int:
    found = 0
    for name in ("cases/values", "cases/end_time", "cases/reason"):
        found = zlib.crc32(np.ascontiguousarray(parts[name][row]).tobytes(), found)
    for part in samples:
        found = zlib.crc32(np.ascontiguousarray(part).tobytes(), found)
    numbers, texts = parts["figures/value"][row], parts["figures/text"][row]
    for values, known in ((numbers, ~np.isnan(numbers)), (texts, texts != b"")):
        columns = np.flatnonzero(known)
        found = zlib.crc32(np.ascontiguousarray(parts["names"][columns]).tobytes(), found)
        found = zlib.crc32(np.ascontiguousarray(values[columns]).tobytes(), found)
    return found
