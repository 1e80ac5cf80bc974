"""Measured signals of files: CSV with units, results of runs, MATLAB's."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.base.files.column_files import Column, read_columns
from vehicledyn.base.units import parse_unit

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Signal:
    """A channel with its SI unit, and the column of a file that measures it.

    ``given_unit`` is that of files that state none; ``noise`` and ``lag`` are in SI.
    """

    channel: str
    column: str
    unit: str
    given_unit: str | None
    noise: float
    lag: float


def read_signals(path: Path, time: str, signals: Sequence[Signal]) -> list[tuple[Floats, Floats]]:
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
    known = {time: Column("s", required=True)}
    known |= {signal.column: Column(signal.unit, required=False) for signal in signals}
    table = read_columns(path, known, is_open=True)
    for signal in signals:
        if signal.given_unit is not None:
            raise InputError(f"{path}: the head of a CSV file states units; leave 'unit' out")
        if signal.column not in table.numbers:
            _require(path, signal.column, table.others)
    times = np.array(table.numbers[time])
    return [(times, np.array(table.numbers[signal.column])) for signal in signals]


def _of_result(path: Path, signals: Sequence[Signal]) -> list[tuple[Floats, Floats]]:
    from vehicledyn.results.labelled.data import open_result

    data = open_result(path)
    found = []
    for signal in signals:
        _require(path, signal.column, list(data))
        values = np.asarray(data[signal.column].to(signal.unit), dtype=float)
        found.append((np.asarray(data.time, dtype=float), values))
    return found


def _of_matlab(path: Path, time: str, signals: Sequence[Signal]) -> list[tuple[Floats, Floats]]:
    from scipy.io import loadmat

    try:
        content = loadmat(path, squeeze_me=True)
    except (ValueError, NotImplementedError, OSError, TypeError) as error:
        raise InputError(f"{path}: cannot be read as a MATLAB file: {error}") from None
    arrays = {name: value for name, value in content.items() if not name.startswith("__")}
    times, found = _numbers(path, time, arrays), []
    for signal in signals:
        if signal.given_unit is None:
            raise InputError(f"{path}: states no units; give signals.{signal.channel}.unit")
        unit = parse_unit(str(signal.given_unit))
        if unit.dimension != parse_unit(signal.unit).dimension:
            raise InputError(
                f"signals.{signal.channel}.unit: '{signal.given_unit}' does not measure a quantity "
                f"in {signal.unit}"
            )
        found.append((times, unit.factor * _numbers(path, signal.column, arrays)))
    return found


def _numbers(path: Path, name: str, arrays: Mapping[str, Any]) -> Floats:
    _require(path, name, arrays)
    try:
        values = np.asarray(arrays[name], dtype=float)
    except (TypeError, ValueError):
        raise InputError(f"{path}: '{name}' holds no real numbers") from None
    if values.ndim != 1:
        raise InputError(f"{path}: '{name}' is no row or column of numbers")
    return values


def _require(path: Path, name: str, known: Iterable[str]) -> None:
    names = list(known)
    if name not in names:
        guess = nearest_name(name, names)
        hint = f"; did you mean '{guess}'?" if guess else ""
        raise InputError(f"{path}: has no column '{name}'{hint}")
