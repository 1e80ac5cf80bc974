"""A cam over a turn as a table in CSV and as a result file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.results.store.consistency import Sizes, require_columns
from vehicledyn.results.store.linear_file import (
    Quantity,
    new_file,
    old_file,
    read_texts,
    write_axis,
    write_numbers,
    write_texts,
)
from vehicledyn.results.tables.columns import Column, write_csv
from vehicledyn.results.tables.key_figures import read_key_figures, write_key_figures

FORMAT = "vehicledyn-cam"
_DRAWN = ("profile_x", "profile_y", "profile_radius", "pitch_x", "pitch_y", "pitch_radius",
          "pressure_angle")  # fmt: skip
"""Columns that every cam has, which figures show."""


@dataclass(frozen=True)
class CamTable:
    """A cam over a turn.

    ``angle`` are angles of the cam, shape (n,) [rad], ``columns`` what is known at each by name;
    ``figures`` are key figures with unit and meaning.
    """

    title: str
    follower: str
    angle: Any
    columns: dict[str, Column]
    figures: dict[str, tuple[float, str, str]]
    notes: tuple[str, ...] = ()


def write_cam(path: Path, table: CamTable) -> None:
    """Write a table as HDF5 if the name ends in .h5, else as CSV with units in its heads.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    if path.suffix == ".h5":
        _write_hdf5(path, table)
        return
    heads = [("angle", "rad"), *((name, c.unit) for name, c in table.columns.items())]
    columns = [table.angle, *(column.values for column in table.columns.values())]
    write_csv(path, heads, zip(*columns, strict=True), digits=15)


def read_cam(path: Path) -> CamTable:
    """Read a table from a result file.

    Raises
    ------
    InputError
        If there is no such file, or it is damaged or of another format.
    """
    with old_file(path, FORMAT) as file:
        figures = {
            quantity.name: (value, quantity.unit, quantity.description)
            for quantity, value in read_key_figures(file)
        }
        sizes = Sizes()
        angle = sizes.read(file, "angle", "angles")
        columns = {
            name: Column(
                str(data.attrs["units"]),
                str(data.attrs["long_name"]),
                sizes.read(file, name, "angles", infinite=True),
            )
            for name, data in file.items()
            if name != "angle" and data.shape == angle.shape and data.dtype.kind == "f"
        }
        require_columns(columns, _DRAWN)
        return CamTable(
            str(file.attrs["title"]),
            str(file.attrs["model"]),
            angle,
            columns,
            figures,
            tuple(read_texts(file, "notes")),
        )


def _write_hdf5(path: Path, table: CamTable) -> None:
    head: dict[str, Any] = {"title": table.title, "model": table.follower}
    head |= {name: value for name, (value, _, _) in table.figures.items()}
    with new_file(path, FORMAT, head) as file:
        scale = write_axis(
            file, "angle", np.asarray(table.angle, float), ("rad", "Angle of the cam")
        )
        for name, column in table.columns.items():
            words = (column.unit, column.description)
            write_numbers(file, name, column.values, (scale,), words)
        write_key_figures(
            file,
            (
                (Quantity(name, unit, meaning), value)
                for name, (value, unit, meaning) in table.figures.items()
            ),
        )
        write_texts(file, "notes", table.notes)
