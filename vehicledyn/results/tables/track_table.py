"""A railway track along its chainage as a table."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.store.consistency import Sizes, require_columns
from vehicledyn.results.store.linear_file import (
    new_file,
    old_file,
    read_texts,
    write_axis,
    write_numbers,
    write_texts,
)
from vehicledyn.results.tables.columns import Column, write_csv

FORMAT = "vehicledyn-track"
_DRAWN = ("s", "x", "y", "curvature", "cant", "gradient", "left_lateral", "left_vertical",
          "right_lateral", "right_vertical")  # fmt: skip
"""Columns that every track has, which figures show."""

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TrackTable:
    """A track, its columns by name of equal length in the units that are shown; s [m] is first.

    ``facts`` are lines that say what the track is.
    """

    title: str
    facts: tuple[str, ...]
    columns: dict[str, Column] = field(default_factory=dict)

    def __getitem__(self, name: str) -> Array:
        """Return the values of a column."""
        values: Array = self.columns[name].values
        return values


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
    heads = [(name, column.unit) for name, column in table.columns.items()]
    rows = zip(*(map(float, column.values) for column in table.columns.values()), strict=True)
    write_csv(path, heads, rows, digits=9, comments=(table.title, *table.facts))


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
            name: Column(
                str(file[name].attrs["units"]),
                str(file[name].attrs["long_name"]),
                sizes.read(file, name, "places", gaps=name not in _DRAWN),
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
            if not scale:
                scale = (write_axis(file, name, np.asarray(column.values, float), words),)
            else:
                write_numbers(file, name, column.values, scale, words)
        write_texts(file, "columns", list(table.columns))
        write_texts(file, "facts", table.facts)
