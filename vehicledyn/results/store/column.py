"""A column of a result file that is read in slices, so that memory stays bounded."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass

import h5py
import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.store.decimation import portions


@dataclass(frozen=True)
class StoredColumn:
    """So many samples of a dataset, read whenever they are asked for."""

    dataset: h5py.Dataset
    count: int
    reading: Callable[[], AbstractContextManager[None]]

    def __len__(self) -> int:
        """Return the number of samples."""
        return self.count

    def __getitem__(self, part: slice) -> NDArray[np.float64]:
        """Return some samples, shape (n,)."""
        start, stop, _ = part.indices(self.count)
        with self.reading():
            return np.asarray(self.dataset[start:stop], dtype=float)

    def first_from(self, wanted: NDArray[np.float64]) -> NDArray[np.intp]:
        """Return the first sample of a rising column not below each wanted value, shape (n,)."""
        places = np.zeros(len(wanted), dtype=np.intp)
        with self.reading():
            for block in portions(self.dataset, self.count):
                places += np.searchsorted(block, wanted)
        return places
