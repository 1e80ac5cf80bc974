"""Two columns of a CSV file whose heads hold the units."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.limits import UnreadableFileError, read_regular
from vehicledyn.base.units import to_si

Array = NDArray[np.float64]
_HEAD = re.compile(r"[^\[\]]*\[([^\[\]]+)\]\s*")
_LARGEST = 5_000_000
_FARTHEST = 1e3
"""Angle, radius or lift that no cam has [rad or m]."""


def read_point_table(
    path: Path, first: Sequence[str], second: Sequence[str]
) -> tuple[Array, Array, str]:
    """Return two columns in SI, and the SI unit of the second.

    Parameters
    ----------
    path
        CSV file; its heads end with the unit in brackets, as ``angle [deg]``.
    first, second
        SI units that each column may have.

    Raises
    ------
    InputError
        If it cannot be read or a number is missing; with the line.
    """
    try:
        text = read_regular(path, _LARGEST).decode("utf-8")
    except UnicodeDecodeError:
        raise InputError(f"{path}: is not a text file; tables are text") from None
    except UnreadableFileError as error:
        raise InputError(f"{path}: {error.words}") from None
    rows = list(csv.reader(text.splitlines()))
    heads = rows[0] if rows else []
    if len(heads) != 2:
        raise InputError(f"{path}:1: two columns are needed, such as 'angle [deg],lift [mm]'")
    factors = [
        _factor(path, head, units) for head, units in zip(heads, (first, second), strict=True)
    ]
    lines = [line for line, row in enumerate(rows[1:], 2) if row]
    values = [_row(path, line, rows[line - 1]) for line in lines]
    if len(values) < 4:
        raise InputError(f"{path}: {len(values)} rows; four are the least")
    found = np.array(values) * [factor for factor, _ in factors]
    beyond = np.argwhere(np.abs(found) > _FARTHEST)
    if len(beyond):
        row, column = beyond[0]
        what = f"{found[row, column]:g} {factors[column][1]}"
        raise InputError(f"{path}:{lines[row]}: {what} is none of a cam; is the unit right?")
    return found[:, 0], found[:, 1], factors[1][1]


def _factor(path: Path, head: str, units: Sequence[str]) -> tuple[float, str]:
    match = _HEAD.fullmatch(head)
    for unit in units if match else ():
        try:
            return to_si(f"1 {match[1]}", unit), unit  # type: ignore[index]
        except InputError:
            continue
    wanted = " or ".join(units)
    raise InputError(
        f"{path}:1: '{head.strip()}': end the head with its unit in brackets, {wanted}"
    )


def _row(path: Path, line: int, row: Sequence[str]) -> tuple[float, float]:
    try:
        first, second = map(float, row)
    except ValueError:
        raise InputError(f"{path}:{line}: expected two numbers, found '{','.join(row)}'") from None
    if not np.isfinite([first, second]).all():
        raise InputError(f"{path}:{line}: expected finite numbers")
    return first, second
