"""Forces of a tyre at loads, slips and cambers, as a table in CSV and HDF5."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.store.consistency import Sizes, require_columns
from vehicledyn.results.store.linear_file import new_file, old_file, write_axis, write_numbers
from vehicledyn.results.tables.columns import write_csv

Array = NDArray[np.float64]

COLUMNS = {
    "load": ("N", "Wheel load"),
    "longitudinal_slip": ("1", "Longitudinal slip"),
    "slip_angle": ("rad", "Slip angle"),
    "camber": ("rad", "Camber"),
    "longitudinal_force": ("N", "Force along the wheel"),
    "lateral_force": ("N", "Force to the left"),
    "aligning_moment": ("N*m", "Moment about the ground normal"),
    "overturning_moment": ("N*m", "Moment about the wheel's heading"),
    "rolling_resistance": ("N*m", "Moment about the spin axis"),
}
"""Columns with their units and meanings, slips first."""

_GIVEN = ("load", "longitudinal_slip", "slip_angle", "camber")
"""Columns of what the wheel does, of which none is missing."""

FORMAT = "vehicledyn-tyre"
_TYRE = "tyre_"


@dataclass(frozen=True)
class TyreTable:
    """Curves of one tyre: for each sweep the columns of :data:`COLUMNS`, of equal length.

    Sweeps are "longitudinal", "lateral", "cambered" and "combined"; ``title`` names the tyre.
    """

    title: str
    sweeps: dict[str, dict[str, Array]]

    def of_load(self, sweep: str, load: float) -> dict[str, Array]:
        """Return the rows of a sweep at one load."""
        columns = self.sweeps[sweep]
        rows = columns["load"] == load
        return {name: values[rows] for name, values in columns.items()}

    @property
    def loads(self) -> list[float]:
        """Loads of the table [N]."""
        return sorted({float(value) for value in self.sweeps["lateral"]["load"]})


def write_tyre(tables: list[TyreTable], path: Path) -> None:
    """Write tables as HDF5 if the name ends in .h5, else as CSV with units in its heads.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    if path.suffix == ".h5":
        _write_hdf5(tables, path)
        return
    heads = [(name, unit) for name, (unit, _) in COLUMNS.items()]
    rows = (
        (table.title, sweep, *numbers)
        for table in tables
        for sweep, columns in table.sweeps.items()
        for numbers in zip(*(columns[name] for name in COLUMNS), strict=True)
    )
    write_csv(path, heads, rows, digits=9, labels=("tyre", "sweep"))


def read_tyres(path: Path) -> list[TyreTable]:
    """Read tables from a result file.

    Raises
    ------
    InputError
        If there is no such file, or it is damaged or of another format.
    """
    with old_file(path, FORMAT) as file:
        found = [
            TyreTable(
                str(group.attrs["title"]),
                _read_sweeps(group),
            )
            for group in file.values()
            if isinstance(group, h5py.Group)
        ]
        if not found:
            raise ValueError("it holds no tyre")
        return found


def _read_sweeps(tyre: h5py.Group) -> dict[str, dict[str, Array]]:
    require_columns(tyre, ("longitudinal", "lateral", "cambered", "combined"))
    return {sweep: _read_columns(group) for sweep, group in tyre.items()}


def _read_columns(group: h5py.Group) -> dict[str, Array]:
    sizes = Sizes()
    return {name: sizes.read(group, name, "points", gaps=name not in _GIVEN) for name in COLUMNS}


def _write_hdf5(tables: list[TyreTable], path: Path) -> None:
    head = {"title": ", ".join(table.title for table in tables)}
    with new_file(path, FORMAT, head) as file:
        for number, table in enumerate(tables, start=1):
            file.create_group(f"{_TYRE}{number}").attrs["title"] = table.title
            for sweep, columns in table.sweeps.items():
                place = f"{_TYRE}{number}/{sweep}"
                points = np.arange(len(columns["load"]), dtype=float)
                scale = write_axis(file, f"{place}/point", points, ("1", "Points of the sweep"))
                for name, words in COLUMNS.items():
                    write_numbers(file, f"{place}/{name}", columns[name], (scale,), words)
