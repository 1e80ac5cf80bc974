"""Measured signals and curves of files: CSV, HDF5, MATLAB's and MDF."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.column_files import ColumnKind, read_columns, stated_units
from vehicledyn.studies.identification.data_columns import (
    DataColumn,
    chosen_unit,
    clean_unit,
    in_si,
    no_column,
)

Floats = NDArray[np.float64]

HDF5_ENDINGS = (".h5", ".hdf5", ".nc")


@dataclass(frozen=True)
class MeasuredSignal:
    """A channel with its SI unit, and the column of a file that measures it.

    ``given_unit`` is that of files that state none; ``noise`` and ``lag`` are in SI.
    """

    channel: str
    column: str
    unit: str
    given_unit: str | None
    noise: float
    lag: float


class CurveColumns(NamedTuple):
    """The column that a curve is over, and that of its values."""

    over: str
    column: str
    over_unit: str | None = None
    unit: str | None = None


class MeasuredCurve(NamedTuple):
    """A curve without its gaps: places (m,) in the unit of ``over``, and the column of its values.

    ``gaps`` is how many places have no value.
    """

    over: str
    over_unit: str
    places: Floats
    values: DataColumn
    gaps: int


def words_on_gaps(count: int) -> str:
    """Return words on samples that are left out."""
    return "1 gap is left out" if count == 1 else f"{count} gaps are left out"


def read_signals(
    path: Path, time: str, signals: Sequence[MeasuredSignal], time_unit: str | None = None
) -> list[tuple[Floats, Floats]]:
    """Return times [s] and values in SI of each signal; a gap is not a number.

    Parameters
    ----------
    path
        CSV file with a head, HDF5 file (.h5, .hdf5, .nc) of ours or others, MATLAB file (.mat) or
        MDF file (.mf4, .mdf, .dat).
    time
        Column of the time, where columns have no times of their own.
    signals
        What to read.
    time_unit
        Unit of the time where the file states none; None for seconds.

    Raises
    ------
    InputError
        If the file or a column cannot be read, or a unit does not fit.
    """
    names = list(dict.fromkeys(signal.column for signal in signals))
    columns = _read(path, names, time)
    shared: Floats | None = None
    found = []
    for signal in signals:
        column = columns[signal.column]
        times = column.times
        if times is None:
            shared = _times(path, time, time_unit) if shared is None else shared
            times = shared
        found.append((times, in_si(path, column, signal.given_unit, signal.unit)))
    return found


def _times(path: Path, time: str, given: str | None) -> Floats:
    """Return the times [s] that the columns of a file share."""
    column = _read(path, [time], time)[time]
    unit = "s" if column.unit is None and given is None else given
    return in_si(path, column, unit, "s", "time_unit")


def read_curve(path: Path, wanted: CurveColumns) -> MeasuredCurve:
    """Return a curve of a file.

    Rows without place and value are passed over, as those of columns that are longer.

    Raises
    ------
    InputError
        If the file or a column cannot be read, a value has no place, or no place has a value.
    """
    columns = _read(path, list(dict.fromkeys([wanted.over, wanted.column])))
    return curve_of_columns(path, columns[wanted.over], columns[wanted.column], wanted.over_unit)


def curve_of_columns(
    path: Path | str, over: DataColumn, values: DataColumn, over_unit: str | None
) -> MeasuredCurve:
    """Return a curve of two columns, ``over_unit`` being that of its places if they state none.

    Raises
    ------
    InputError
        If the columns do not fit together, a value has no place, or no place has a value.
    """
    if np.iscomplexobj(over.values):
        raise InputError(f"{path}: '{over.name}' holds complex numbers", about=(over.name,))
    if len(over.values) != len(values.values):
        words = f"'{over.name}' and '{values.name}' are not of the same length"
        raise InputError(f"{path}: {words}", about=(over.name,))
    if not _same_times(over, values):
        words = f"'{over.name}' and '{values.name}' are not sampled at the same times"
        raise InputError(f"{path}: {words}", about=(over.name,))
    for column in (over, values):
        if (endless := np.isinf(column.values)).any():
            where = column.place(path, int(np.argmax(endless)))
            raise InputError(f"{where}: '{column.name}' is not finite", about=(column.name,))
    no_place, no_value = np.isnan(over.values), np.isnan(values.values)
    if (lost := no_place & ~no_value).any():
        where = over.place(path, int(np.argmax(lost)))
        raise InputError(f"{where}: '{over.name}' has no value", about=(over.name,))
    kept = ~no_value
    if not kept.any():
        words = f"column '{values.name}' has no value; all are gaps"
        raise InputError(f"{path}: {words}", about=(values.name,))
    return MeasuredCurve(
        over.name,
        chosen_unit(path, over, over_unit, "over_unit"),
        over.values[kept],
        values._replace(values=values.values[kept], times=None, lines=()),
        int((no_value & ~no_place).sum()),
    )


def _same_times(one: DataColumn, other: DataColumn) -> bool:
    """Return whether columns that have times of their own have the same."""
    return one.times is None or other.times is None or np.array_equal(one.times, other.times)


def _read(path: Path, names: Sequence[str], time: str = "") -> dict[str, DataColumn]:
    """Return columns of a file by name; every line of a text has a ``time``."""
    return dict(zip(names, _reader(path)(path, names, time), strict=True))


def _reader(path: Path) -> Any:
    """Return what reads the columns of a file, by its ending."""
    ending = path.suffix.lower()
    if ending in HDF5_ENDINGS:
        from vehicledyn.studies.identification.hdf5_data import read_hdf5

        return lambda path, names, *_: read_hdf5(path, names)
    from vehicledyn.studies.identification.foreign_reader import read_apart
    from vehicledyn.studies.identification.mdf_data import is_mdf

    if ending == ".mat":
        return lambda path, names, *_: read_apart("MATLAB", path, names)
    if ending in (".mf4", ".mdf") or (ending == ".dat" and is_mdf(path)):
        return lambda path, names, *_: read_apart("MDF", path, names)
    return _of_text


def _of_text(path: Path, names: Sequence[str], time: str) -> list[DataColumn]:
    """Return columns of a text, with the units that its head states."""
    stated = stated_units(path)
    for name in names:
        if name not in stated:
            raise no_column(path, name, stated)
    known = {
        name: ColumnKind("1", required=name == time, may_be_nan=name != time, is_raw=True)
        for name in dict.fromkeys([*names, *([time] if time in stated else [])])
    }
    table = read_columns(path, known, is_open=True)
    return [
        DataColumn(name, np.array(table.numbers[name]), clean_unit(stated[name]), None, table.lines)
        for name in names
    ]
