"""Columns of tables, and tables as CSV with units in their heads."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vehicledyn.base.files.whole_file import whole_file
from vehicledyn.results.hdf5.output import write_failed


@dataclass(frozen=True)
class Column:
    """Unit, meaning and values of a column, shape (n,)."""

    unit: str
    description: str
    values: Any


def write_csv(
    path: Path,
    heads: Iterable[tuple[str, str]],
    rows: Iterable[Sequence[str | float]],
    *,
    digits: int,
    labels: Sequence[str] = (),
    comments: Iterable[str] = (),
) -> None:
    """Write a table.

    Parameters
    ----------
    path
        The file.
    heads
        Name and unit of each column of numbers.
    rows
        Texts of the labels, then the numbers.
    digits
        Significant digits of numbers.
    labels
        Names of columns of texts, which come first.
    comments
        Lines above the heads.

    Raises
    ------
    InputError
        If the file cannot be written.
    """
    try:
        with whole_file(path) as place, place.open("w", encoding="utf-8", newline="") as stream:
            stream.writelines(f"# {line}\n" for line in comments)
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow([*labels, *(f"{name} [{unit}]" for name, unit in heads)])
            for row in rows:
                writer.writerow([v if isinstance(v, str) else f"{v:.{digits}g}" for v in row])
    except OSError as error:
        raise write_failed(path, error) from error
