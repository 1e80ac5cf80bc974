"""Measured signals of files: CSV with units, results of runs, MATLAB's."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.base.files.column_files import ColumnKind, read_columns
from vehicledyn.base.units import parse_unit

Floats = NDArray[np.float64]


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


def words_on_gaps(count: int) -> str:
    """Return words on samples that are left out."""
    return "1 gap is left out" if count == 1 else f"{count} gaps are left out"


def read_signals(
    path: Path, time: str, signals: Sequence[MeasuredSignal]
) -> list[tuple[Floats, Floats]]:
    """Return times [s] and values in SI of each signal; a gap is not a number.

    Parameters
    ----------
    path
        CSV file whose head states units, result of a run (.h5), or MATLAB file (.mat).
    time
        Column of the time.
    signals
        What to read.

    Raises
    ------
    InputError
        If the file or a column cannot be read, or a unit does not fit.
    """
    if path.suffix in (".h5", ".hdf5", ".nc"):
        return _of_result(path, signals)
    if path.suffix == ".mat":
        return _of_matlab(path, time, signals)
    known = {time: ColumnKind("s", required=True)}
    known |= {signal.column: ColumnKind(signal.unit, may_be_nan=True) for signal in signals}
    table = read_columns(path, known, is_open=True)
    for signal in signals:
        if signal.given_unit is not None:
            words = "the head of a CSV file states units; leave 'unit' out"
            raise InputError(f"{path}: {words}", about=(signal.column,))
        if signal.column not in table.numbers:
            _require(path, signal.column, table.others)
    times = np.array(table.numbers[time])
    return [(times, np.array(table.numbers[signal.column])) for signal in signals]


def _of_result(path: Path, signals: Sequence[MeasuredSignal]) -> list[tuple[Floats, Floats]]:
    from vehicledyn.results.labelled.data import open_result

    data = open_result(path)
    found = []
    for signal in signals:
        _require(path, signal.column, list(data))
        try:
            values = np.asarray(data[signal.column].to(signal.unit), dtype=float)
        except InputError as error:
            raise InputError(f"{path}: {signal.column}: {error}", about=(signal.column,)) from None
        found.append((np.asarray(data.time, dtype=float), values))
    return found


def _of_matlab(
    path: Path, time: str, signals: Sequence[MeasuredSignal]
) -> list[tuple[Floats, Floats]]:
    from scipy.io import loadmat

    try:
        content = loadmat(path, squeeze_me=True)
    except (ValueError, NotImplementedError, OSError, TypeError) as error:
        raise InputError(f"{path}: cannot be read as a MATLAB file: {error}") from None
    arrays = {name: value for name, value in content.items() if not name.startswith("__")}
    times, found = _numbers(path, time, arrays), []
    for signal in signals:
        if signal.given_unit is None:
            words = "states no units; give 'unit' of the signal"
            raise InputError(f"{path}: {words}", about=(signal.column,))
        try:
            unit = parse_unit(str(signal.given_unit))
        except InputError as error:
            raise InputError(f"unit: {error}", about=(signal.column,)) from None
        if unit.dimension != parse_unit(signal.unit).dimension:
            words = f"'{signal.given_unit}' does not measure a quantity in {signal.unit}"
            raise InputError(f"unit: {words}", about=(signal.column,))
        values = unit.factor * _numbers(path, signal.column, arrays)
        found.append((times, values))
    return found


def _numbers(path: Path, name: str, arrays: Mapping[str, Any]) -> Floats:
    _require(path, name, arrays)
    try:
        values = np.asarray(arrays[name], dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"{path}: '{name}' holds no real numbers", about=(name,)) from None
    if values.ndim != 1:
        raise InputError(f"{path}: '{name}' is no row or column of numbers", about=(name,))
    return values


def _require(path: Path, name: str, known: Iterable[str]) -> None:
    names = list(known)
    if name not in names:
        guess = nearest_name(name, names)
        hint = f"; did you mean '{guess}'?" if guess else ""
        raise InputError(f"{path}: has no column '{name}'{hint}", about=(name,))
