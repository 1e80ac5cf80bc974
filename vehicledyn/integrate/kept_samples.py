"""The samples of a run that its key figures are made from, in one block of memory."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vehicledyn.kernel.engine import Vector


class KeptSamples:
    """Keeps times and some channels of samples, one row each, in order.

    Parameters
    ----------
    expected
        How many there are likely to be; more fit, too.
    columns
        The channels to keep, as columns of the outputs.
    """

    def __init__(self, expected: int, columns: Sequence[int]) -> None:
        self._columns = np.array(columns, dtype=np.intp)
        self._count = 0
        self._times = np.empty(expected)
        self._values = np.empty((expected, len(columns)))

    def take(self, times: Vector, outputs: Vector) -> Vector:
        """Keep samples; return the channels kept of them, shape (n_samples, n_columns)."""
        first, self._count = self._count, self._count + len(times)
        if self._count > len(self._times):
            more = max(self._count, 2 * len(self._times)) - len(self._times)
            self._times = np.pad(self._times, (0, more))
            self._values = np.pad(self._values, ((0, more), (0, 0)))
        self._times[first : self._count] = times
        room = self._values[first : self._count]
        np.take(outputs, self._columns, axis=1, out=room, mode="clip")
        return room

    @property
    def times(self) -> Vector:
        """Times of the samples, shape (n_samples,) [s]."""
        return self._times[: self._count]

    @property
    def values(self) -> Vector:
        """Channels of the samples, shape (n_samples, n_columns)."""
        return self._values[: self._count]
