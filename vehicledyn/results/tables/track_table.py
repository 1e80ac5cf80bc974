"""A railway track along its chainage as a table."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.files.whole_file import whole_file
from vehicledyn.results.hdf5.output import write_failed

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TrackColumn:
    """Values along the track in the unit in which they are shown."""

    unit: str
    values: Array
    description: str


@dataclass(frozen=True)
class TrackTable:
    """A track, its columns by name of equal length; s [m] is the first.

    ``facts`` are lines that say what the track is.
    """

    title: str
    facts: tuple[str, ...]
    columns: dict[str, TrackColumn] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Array:
        """Return the values of a column."""
        return self.columns[name].values

    def heads(self) -> list[str]:
        """Return the heads of the columns with their units."""
        return [f"{name} [{column.unit}]" for name, column in self.columns.items()]

    def rows(self) -> Iterable[tuple[float, ...]]:
        """Return the table line by line."""
        return zip(*(map(float, c.values) for c in self.columns.values()), strict=True)


def write_track(table: TrackTable, path: Path) -> None:
    """Write a table as CSV, with the units in its heads.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    try:
        with whole_file(path) as place, place.open("w", encoding="utf-8", newline="") as stream:
            for line in (table.title, *table.facts):
                stream.write(f"# {line}\n")
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(table.heads())
            writer.writerows([f"{value:.9g}" for value in row] for row in table.rows())
    except OSError as error:
        raise write_failed(path, error) from error
