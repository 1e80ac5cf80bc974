"""Columns of a result file, compared with their checksums where they are first read."""

from __future__ import annotations

from dataclasses import dataclass, field

import h5py

from vehicledyn.results.hdf5.damage import rows_in_words
from vehicledyn.results.hdf5.opening import OpenFile
from vehicledyn.results.hdf5.seal import DamagedError
from vehicledyn.results.store.layout import dataset_path
from vehicledyn.results.store.row_checksums import check_rows


@dataclass
class CheckedColumns:
    """Datasets by name: "time", those of ``channels``, and "states/value"."""

    file: OpenFile
    channels: tuple[str, ...]
    samples: int
    _sound: set[str] = field(default_factory=set)

    def __getitem__(self, name: str) -> h5py.Dataset:
        """Return a column whose samples are sound.

        They are compared once, unless every byte of the file is checked anyway.

        Raises
        ------
        DamagedError
            If they are not.
        """
        dataset, guard = self.file[dataset_path(name)], self.file.guard
        if guard is None or guard.is_sealed or name in self._sound:
            return dataset
        number = {"time": 0, "states/value": -1}.get(name)
        if number is None:
            number = 1 + self.channels.index(name)
        try:
            check_rows(self.file, number, dataset, self.samples)
        except DamagedError as error:
            words = rows_in_words(self.file, name, error.first, error.last)
            raise DamagedError(f"{error} of {words}") from error
        self._sound.add(name)
        return dataset
