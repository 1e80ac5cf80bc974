"""Arrays of a result as tables of other programs: CSV, MATLAB files and Parquet."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import InputError, MissingPartError
from vehicledyn.base.files.whole_file import whole_file
from vehicledyn.results.hdf5.output import write_failed
from vehicledyn.results.labelled.conversion import labels_along, table_arrays
from vehicledyn.results.labelled.labels import Labelled, LabelledSet
from vehicledyn.results.store.reader import open_result

_LONGEST_NAME = 63
"""Letters of a name in MATLAB."""

_ROWS = 10_000
"""Rows of a CSV file that are made into numbers of Python's at once."""

_VALUES = 1 << 21
"""Values of all columns that are read from a file at once."""

_NO_LETTER = re.compile(r"\W")


def export_data(
    data: LabelledSet, path: Path, patterns: Sequence[str], *, overwrite: bool = False
) -> Path:
    """Write arrays over the same dimensions as a table; return its path.

    CSV has names in its first line and units in its second; MATLAB files and Parquet carry units
    and meanings beside the columns.

    Parameters
    ----------
    data
        The result.
    path
        File to write; its ending .csv, .mat or .parquet decides the format.
    patterns
        Names or shell patterns of arrays, empty for those of the usual table.
    overwrite
        Whether an existing file is replaced.

    Raises
    ------
    InputError
        If the ending is another, the file exists or cannot be written, or the arrays make no table.
    MissingPartError
        If the package for Parquet is not installed.
    """
    write = _WRITERS.get(path.suffix.lower())
    if write is None:
        raise InputError(f"{path}: give a file that ends in {', '.join(_WRITERS)}")
    if path.exists() and not overwrite:
        raise InputError(f"{path}: exists; choose another file, or give {argument('overwrite')}")
    try:
        with ExitStack() as open_files:
            columns = list(_stored_columns(data, patterns, open_files))
            if not columns:
                columns = list(_columns(table_arrays(data, patterns)))
                _refuse_ragged(data.path, columns)
            write(open_files.enter_context(whole_file(path)), columns, data)
    except OSError as error:
        raise write_failed(path, error) from error
    return path


Column = tuple[str, Any, str, str]
"""Name, values or what reads some of them from a file, unit and meaning."""


def _stored_columns(
    data: LabelledSet, patterns: Sequence[str], open_files: ExitStack
) -> Iterator[Column]:
    """Yield the columns of a run, which stay in its file until they are written.

    There are none where nothing but the labels of the samples is asked for.
    """
    if data.kind != "run":
        return
    axis = next(iter(data))
    names = [name for name in data.names(*patterns) if name != axis]
    if not names:
        return
    result = open_files.enter_context(open_result(data.path))
    label = data[axis]
    yield axis, result.column("time"), label.unit, label.description
    for name in names:
        unit, words, _ = result.facts(name)
        yield name, result.column(name), unit, words


def _columns(arrays: Sequence[Labelled]) -> Iterator[Column]:
    """Yield the labels of the rows, then the arrays; complex ones as two columns."""
    first = arrays[0]
    for dim, values in labels_along(first):
        label = first.coords.get(dim)
        yield dim, values, label.unit if label else "", label.description if label else ""
    for array in arrays:
        values = np.ravel(array.values)
        if np.iscomplexobj(values):
            yield f"{array.name}.real", values.real, array.unit, array.description
            yield f"{array.name}.imag", values.imag, array.unit, array.description
        else:
            yield array.name, values, array.unit, array.description


def _refuse_ragged(path: Path, columns: Sequence[Column]) -> None:
    """Raise InputError unless all columns are equally long."""
    counts = {name: len(values) for name, values, *_ in columns}
    first = next(iter(counts))
    for name, count in counts.items():
        if count != counts[first]:
            words = f"{name} has {count} values, not {counts[first]} as {first}"
            raise InputError(f"{path}: is damaged ({words}); compute it again")


def _portions(columns: Sequence[Column]) -> Iterator[list[np.ndarray[Any, Any]]]:
    """Yield the same rows of all columns, some of them at once."""
    rows = max(_ROWS, _VALUES // len(columns))
    for first in range(0, max(len(values) for _, values, *_ in columns), rows):
        yield [np.asarray(values[first : first + rows]) for _, values, *_ in columns]


def _write_csv(path: Path, columns: Sequence[Column], data: LabelledSet) -> None:
    with path.open("w", encoding="utf-8", errors="backslashreplace", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow([name for name, *_ in columns])
        writer.writerow([unit for _, _, unit, _ in columns])
        for arrays in _portions(columns):
            for start in range(0, len(arrays[0]), _ROWS):
                parts = (array[start : start + _ROWS].tolist() for array in arrays)
                writer.writerows(zip(*parts, strict=True))


def _write_mat(path: Path, columns: Sequence[Column], data: LabelledSet) -> None:
    """Write variables under names that MATLAB allows, with a table of their own names and units."""
    from scipy.io import savemat

    names = _matlab_names([name for name, *_ in columns])
    facts = np.array([[n, *c[:1], *c[2:]] for n, c in zip(names, columns, strict=True)], object)
    head = {"title": data.title, "model": data.model, "status": data.status}
    with path.open("wb") as file:
        for name, (_, values, *_) in zip(names, columns, strict=True):
            variable = {name: np.asarray(values[:])}  # written one by one, as each is in memory
            savemat(file, variable, long_field_names=True, oned_as="column")
        content = {"columns": facts, "about": head}
        savemat(file, content, long_field_names=True, oned_as="column")


def _matlab_names(names: Sequence[str]) -> list[str]:
    """Return names of letters, digits and underscores, each another."""
    found: dict[str, None] = {}
    numbers: dict[str, int] = {}
    for name in names:
        plain = _NO_LETTER.sub("_", name)
        stem = plain if plain[:1].isalpha() else f"x{plain}"
        word, short = stem[:_LONGEST_NAME], stem[: _LONGEST_NAME - 6]
        while word in found or word in ("columns", "about"):
            numbers[short] = numbers.get(short, 1) + 1
            word = f"{short}_{numbers[short]}"
        found[word] = None
    return list(found)


def _write_parquet(path: Path, columns: Sequence[Column], data: LabelledSet) -> None:
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        raise MissingPartError(
            "Parquet files need pyarrow; install it with: pip install 'vehicledyn[parquet]'"
        ) from None
    fields = [
        pyarrow.field(
            name, pyarrow.array(values[:1]).type, metadata={"units": unit, "long_name": words}
        )
        for name, values, unit, words in columns
    ]
    head = {"title": data.title, "model": data.model, "status": data.status}
    schema = pyarrow.schema(fields, metadata=head)
    with parquet.ParquetWriter(path, schema) as writer:
        for arrays in _portions(columns):
            writer.write_table(pyarrow.Table.from_arrays(arrays, schema=schema))


_WRITERS: dict[str, Callable[[Path, Sequence[Column], LabelledSet], None]] = {
    ".csv": _write_csv,
    ".mat": _write_mat,
    ".parquet": _write_parquet,
}
