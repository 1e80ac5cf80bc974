"""A signal of any length that is read block by block; what is computed lies on the disk."""

from __future__ import annotations

import os
import tempfile
import weakref
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.assessment.order_statistics import percentiles

Floats = NDArray[np.float64]

BLOCK = 1 << 18
"""Samples that are in memory at once, about."""


@dataclass(frozen=True)
class Signal:
    """Values that ``read(start, stop)`` gives, ``count`` in all, shape (n,)."""

    count: int
    read: Callable[[int, int], Floats]

    def part(self, start: int, stop: int) -> Floats:
        """Return the values from one sample up to another."""
        return self.read(start, min(stop, self.count))

    def blocks(self, size: int | None = None) -> Iterator[Floats]:
        """Yield all values, a bounded number at once."""
        step = size or BLOCK
        for start in range(0, self.count, step):
            yield self.part(start, start + step)

    def at(self, place: int) -> float:
        """Return one value, from the end for negative places."""
        start = place % self.count
        return float(self.part(start, start + 1)[0])

    def section(self, kept: slice) -> Signal:
        """Return the values of a section."""
        first = kept.start
        return Signal(kept.stop - first, lambda a, b: self.read(first + a, first + b))

    def percentiles(self, *wanted: float) -> list[float]:
        """Return percentiles [%]; those of NumPy, also of what no memory holds."""
        if self.count <= BLOCK:
            return [float(one) for one in np.percentile(self.part(0, self.count), wanted)]
        return percentiles(self.blocks, self.count, wanted)

    def median(self) -> float:
        """Return the median."""
        return self.percentiles(50.0)[0]

    def smallest(self) -> float:
        """Return the smallest value."""
        return min(float(block.min()) for block in self.blocks())

    def highest(self) -> tuple[int, float]:
        """Return the place of the largest value, the first of equal ones, and the value."""
        found, start = (0, -np.inf), 0
        for block in self.blocks():
            at = int(np.argmax(block))
            if block[at] > found[1]:
                found = (start + at, float(block[at]))
            start += len(block)
        return found

    def mean_square(self) -> float:
        """Return the mean of the squares."""
        if self.count <= BLOCK:
            return float(np.mean(self.part(0, self.count) ** 2))
        return sum(float(np.sum(block**2)) for block in self.blocks()) / self.count


def signal_of(values: Sequence[float] | Floats) -> Signal:
    """Return values in memory, or a column of a file that slices like one, as a signal."""
    return Signal(len(values), lambda a, b: np.asarray(values[a:b], dtype=float))


def combined(function: Callable[..., Floats], *signals: Signal) -> Signal:
    """Return what a function makes of signals, value by value, whenever it is read."""
    return Signal(
        min(signal.count for signal in signals),
        lambda a, b: np.asarray(function(*(signal.part(a, b) for signal in signals))),
    )


def stored(blocks: Iterable[Floats]) -> Signal:
    """Return blocks that are computed once: one in memory, more of them in a temporary file."""
    parts = iter(blocks)
    first = next(parts, np.empty(0))
    second = next(parts, None)
    if second is None:
        return signal_of(first)
    file = tempfile.TemporaryFile()  # noqa: SIM115 closed with the function that reads it
    count = 0
    for part in (first, second):
        count += _write(file.fileno(), part)
    for part in parts:
        count += _write(file.fileno(), part)

    def read(start: int, stop: int) -> Floats:
        return np.frombuffer(os.pread(file.fileno(), 8 * (stop - start), 8 * start))

    weakref.finalize(read, file.close)
    return Signal(count, read)


def _write(number: int, values: Floats) -> int:
    data = memoryview(np.asarray(values, dtype=float).tobytes())
    while data:
        data = data[os.write(number, data) :]
    return len(values)
