"""Columns of HDF5 files: results of ours, and datasets that other programs wrote."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.limits import check_regular
from vehicledyn.results.hdf5.damage import reading
from vehicledyn.results.hdf5.opening import open_file
from vehicledyn.results.hdf5.superblock import SIGNATURE
from vehicledyn.results.store.linear_file import format_of
from vehicledyn.studies.identification.data_columns import (
    MOST_VALUES,
    DataColumn,
    clean_unit,
    matrix_of,
    no_column,
    numbers_of,
)

_OURS = "vehicledyn"
_UNIT = ("units", "unit", "Units", "Unit")
_ADVICE = "write it again"
_MOST_NAMES = 10_000


def read_hdf5(path: Path, names: Sequence[str]) -> list[DataColumn]:
    """Return columns of a result, or of datasets by their paths, such as ``bench/travel``.

    A field of a table is ``table/field``, a column of a matrix ``matrix(:,2)``. The unit is that
    of an attribute ``units`` or ``unit``; gaps and scales of NetCDF are heeded.

    Raises
    ------
    InputError
        If the file is damaged, or a column is missing or holds no numbers.
    """
    check_regular(path)
    if format_of(path).startswith(_OURS):
        return _of_result(path, names)
    with _opened(path) as file, reading(path, file, _ADVICE):
        return [_column(path, file, name) for name in names]


def _of_result(path: Path, names: Sequence[str]) -> list[DataColumn]:
    from vehicledyn.results.labelled.data import open_result

    data, found = open_result(path), []
    for name in names:
        if matrix_of(name) not in data:
            raise no_column(path, name, data)
        array = data[matrix_of(name)]
        times = np.asarray(array.time, dtype=float) if array.dims == ("time",) else None
        values = numbers_of(path, name, array.values)
        found.append(DataColumn(name, values, clean_unit(array.unit), times))
    return found


@contextlib.contextmanager
def _opened(path: Path) -> Iterator[h5py.File]:
    """Give a file of another program; MATLAB's begin with a block of their own."""
    with path.open("rb") as start:
        is_plain = start.read(len(SIGNATURE)) == SIGNATURE
    if not is_plain and not h5py.is_hdf5(path):
        raise InputError(f"{path}: is no HDF5 file")
    with reading(path, advice=_ADVICE):
        file = open_file(path) if is_plain else h5py.File(path, "r", locking=False)
    with file:
        yield file


def _column(path: Path, file: h5py.File, name: str) -> DataColumn:
    """Return a column of a dataset, or of a field of a table."""
    place = matrix_of(name)
    dataset = _dataset(file, place) or _dataset(file, place.replace(".", "/"))
    field = None
    if dataset is None:
        group, _, field = place.replace(".", "/").rpartition("/")
        dataset = _dataset(file, group)
        if dataset is None or field not in (dataset.dtype.names or ()):
            raise no_column(path, name, _names(file))
    if dataset.shape is None or dataset.size > MOST_VALUES:
        raise InputError(f"{path}: '{name}' is empty or too large to read", about=(name,))
    values = np.asarray(dataset[()] if field is None else dataset[field])
    if values.dtype.names == ("real", "imag"):  # as MATLAB writes complex numbers
        values = values["real"] + 1j * values["imag"]
    facts = {} if field is not None else dataset.attrs
    if facts.get("MATLAB_class") in (b"char", "char"):
        raise InputError(f"{path}: '{name}' holds no numbers", about=(name,))
    numbers = _unpacked(numbers_of(path, name, values), facts)
    unit = next((clean_unit(_text(facts[key])) for key in _UNIT if key in facts), None)
    return DataColumn(name, numbers, unit)


def _dataset(file: h5py.File, place: str) -> h5py.Dataset | None:
    found = file.get(place) if place.strip("/") else None
    return found if isinstance(found, h5py.Dataset) else None


def _names(file: h5py.File) -> list[str]:
    """Return the paths of datasets and of the fields of tables."""
    found: list[str] = []

    def look(name: str, item: Any) -> bool | None:
        if isinstance(item, h5py.Dataset):
            found.extend(f"{name}/{field}" for field in item.dtype.names or ())
            found.append(name)
        return len(found) > _MOST_NAMES or None

    file.visititems(look)
    return found


def _unpacked(values: Any, facts: Any) -> Any:
    """Return values with the gaps and the scale that attributes of NetCDF state."""
    for key in ("_FillValue", "missing_value"):
        if key in facts:
            values = np.where(values == np.ravel(facts[key])[0], np.nan, values)
    factor, offset = (
        float(np.ravel(facts.get(key, default))[0])
        for key, default in (("scale_factor", 1.0), ("add_offset", 0.0))
    )
    return values if (factor, offset) == (1.0, 0.0) else values * factor + offset


def _text(value: Any) -> Any:
    """Return the text of an attribute, which may be a list of one."""
    return np.ravel(np.asarray(value, dtype=object))[0] if np.size(value) == 1 else ""
