"""A railway track along its chainage as a table."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.files.whole_file import whole_file
from vehicledyn.results.hdf5.output import write_failed
from vehicledyn.results.store.consistency import Sizes, require_columns
from vehicledyn.results.store.linear_file import (
    new_file,
    old_file,
    read_texts,
    write_numbers,
    write_texts,
)

FORMAT = "vehicledyn-track"
_DRAWN = ("s", "x", "y", "curvature", "cant", "gradient", "left_lateral", "left_vertical",
          "right_lateral", "right_vertical")  # fmt: skip
"""Columns that every track has, which figures show."""

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
    """Write a table as HDF5 if the name ends in .h5, else as CSV with units in its heads.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    if path.suffix == ".h5":
        _write_hdf5(table, path)
        return
    try:
        with whole_file(path) as place, place.open("w", encoding="utf-8", newline="") as stream:
            for line in (table.title, *table.facts):
                stream.write(f"# {line}\n")
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(table.heads())
            writer.writerows([f"{value:.9g}" for value in row] for row in table.rows())
    except OSError as error:
        raise write_failed(path, error) from error


def read_track_table(path: Path) -> TrackTable:
    """Read a table from a result file.

    Raises
    ------
    InputError
        If there is no such file, or it is damaged or of another format.
    """
    with old_file(path, FORMAT) as file:
        names, sizes = read_texts(file, "columns"), Sizes()
        columns = {
            name: TrackColumn(
                str(file[name].attrs["units"]),
                sizes.read(file, name, "places", gaps=name not in _DRAWN),
                str(file[name].attrs["long_name"]),
            )
            for name in names
        }
        require_columns(columns, _DRAWN)
        return TrackTable(str(file.attrs["title"]), tuple(read_texts(file, "facts")), columns)


def _write_hdf5(table: TrackTable, path: Path) -> None:
    with new_file(path, FORMAT, {"title": table.title}) as file:
        scale: tuple[h5py.Dataset, ...] = ()
        for name, column in table.columns.items():
            words = (column.unit, column.description)
            write_numbers(file, name, column.values, scale, words)
            if not scale:
                file[name].make_scale(name)
                scale = (file[name],)
        write_texts(file, "columns", list(table.columns))
        write_texts(file, "facts", table.facts)
