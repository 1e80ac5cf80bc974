"""Reading columns of any length in bounded memory: their envelope, their range."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import h5py
import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

PORTION = 1 << 18
"""Values that are read at once, about."""
SUSPECT = 1 << 26
"""Bytes from which a dataset must have stored what it says it holds."""
MOST_PACKED = 1100
"""By how much the packings of HDF5 can shrink zeros, at most."""


@dataclass(frozen=True)
class Thinning:
    """Which samples of a column are shown: all, or two of every ``block``.

    The two are the smallest and the largest value of the block, in the order in which they
    occur, so that no peak is lost; their times are those of the block's first and middle sample.
    The last time is that of the last sample.
    """

    length: int
    block: int = 1

    def times(self, dataset: h5py.Dataset) -> Floats:
        """Return the times of the samples shown [s]."""
        if self.block == 1:
            return np.asarray(dataset[: self.length], dtype=float)
        picked = []
        for values in portions(dataset, self.length, self.block):
            places = np.arange(0, len(values), self.block)
            middle = np.minimum(places + self.block // 2, len(values) - 1)
            picked.append(np.stack([values[places], values[middle]], axis=1).ravel())
        picked[-1][-1] = dataset[self.length - 1]
        return np.concatenate(picked)

    def values(self, dataset: h5py.Dataset) -> Floats:
        """Return the values shown; a block without any number gives none."""
        if self.block == 1:
            return np.asarray(dataset[: self.length], dtype=float)
        found = [_envelope(v, self.block) for v in portions(dataset, self.length, self.block)]
        return np.concatenate(found)


def thinned(length: int, most: int | None) -> Thinning:
    """Return how to show at most so many samples of a column, all of them if None.

    Of the longest columns a few more are shown, as no more than a portion is in memory at once.
    """
    if most is None or length <= most:
        return Thinning(length)
    return Thinning(length, min(-(-2 * length // most), PORTION))


def portions(dataset: h5py.Dataset, length: int, block: int = 1) -> Iterator[Floats]:
    """Yield the values of a column, a bounded number at once."""
    step = max(1, PORTION // block) * block
    for start in range(0, length, step):
        yield np.asarray(dataset[start : min(start + step, length)], dtype=float)


@dataclass(frozen=True)
class ColumnRange:
    """Smallest and largest finite value of a column, None without any, and how many are none."""

    smallest: float | None
    largest: float | None
    not_finite: int


def column_range(dataset: h5py.Dataset, length: int) -> ColumnRange:
    """Return the range of a column, read a portion at a time."""
    low, high, bad = np.inf, -np.inf, 0
    for values in portions(dataset, length):
        finite = values[np.isfinite(values)]
        bad += values.size - finite.size
        if finite.size:
            low, high = min(low, float(finite.min())), max(high, float(finite.max()))
    known = low <= high
    return ColumnRange(low if known else None, high if known else None, bad)


def promises_too_much(dataset: h5py.Dataset) -> bool:
    """Return whether a dataset says to hold far more than is stored, or has it elsewhere."""
    if dataset.external or dataset.is_virtual:
        return True
    size = dataset.size * dataset.dtype.itemsize
    return bool(size > SUSPECT and size > MOST_PACKED * dataset.id.get_storage_size())


def _envelope(values: Floats, block: int) -> Floats:
    whole = len(values) // block * block
    pairs = _pairs(values[:whole].reshape(-1, block))
    rest = values[whole:]
    return np.concatenate([pairs, _pairs(rest[None, :])]) if len(rest) else pairs


def _pairs(rows: Floats) -> Floats:
    """Return smallest and largest number of every row, in the order in which they occur."""
    known = np.isfinite(rows)
    first = np.argmin(np.where(known, rows, np.inf), axis=1)
    second = np.argmax(np.where(known, rows, -np.inf), axis=1)
    places = np.sort(np.stack([first, second], axis=1), axis=1)
    found: Floats = np.take_along_axis(rows, places, axis=1)
    found[~known.any(axis=1)] = np.nan
    return found.ravel()
