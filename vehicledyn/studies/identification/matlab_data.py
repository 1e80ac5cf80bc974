"""Columns of MATLAB files: variables, fields of structs and columns of matrices."""

from __future__ import annotations

import zlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.limits import open_regular
from vehicledyn.studies.identification.data_columns import (
    DataColumn,
    matrix_of,
    no_column,
    numbers_of,
)

_BROKEN = (
    ValueError,
    TypeError,
    LookupError,
    AttributeError,
    OSError,
    EOFError,
    NotImplementedError,
    OverflowError,
    MemoryError,
    zlib.error,
)
"""What SciPy raises on files that do not hold what they should."""
_HDF5 = b"MATLAB 7.3"


def read_matlab(path: Path, names: Sequence[str]) -> list[DataColumn]:
    """Return columns by variable, ``struct.field`` or column of a matrix, ``matrix(:,2)``.

    Files of version 7.3 are HDF5 and read as such.

    Raises
    ------
    InputError
        If the file is damaged, or a column is missing or holds no numbers.
    """
    with open_regular(path) as file:
        start = file.read(len(_HDF5))
    if start == _HDF5:
        from vehicledyn.studies.identification.hdf5_data import read_hdf5

        return read_hdf5(path, names)
    arrays = dict(_variables(_content(path)))
    found = []
    for name in names:
        if matrix_of(name) not in arrays:
            raise no_column(path, name, arrays)
        found.append(DataColumn(name, numbers_of(path, name, arrays[matrix_of(name)])))
    return found


def _content(path: Path) -> Mapping[str, Any]:
    from scipy.io import loadmat
    from scipy.io.matlab import MatReadError

    try:
        content: Mapping[str, Any] = loadmat(path, simplify_cells=True)
    except (*_BROKEN, MatReadError) as error:
        raise InputError(f"{path}: cannot be read as a MATLAB file: {error}") from None
    return {name: value for name, value in content.items() if not name.startswith("__")}


def _variables(content: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield variables by name, and fields of structs by theirs joined with dots."""
    for name, value in content.items():
        if isinstance(value, dict):
            yield from _variables(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value
