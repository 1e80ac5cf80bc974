"""Tables along a track: chainages that grow without gaps, sizes that can be."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.files.column_files import ColumnKind, Columns, read_columns
from vehicledyn.base.problems import Problem, refusal

Array = NDArray[np.float64]

FARTHEST = 1e7
"""Chainage that no track has, from a beginning far away either [m]."""

WIDEST_GAP = 5.0
"""Distance of two lines, by the usual one, beyond which something is missing in between."""


def read_along(
    path: Path, known: dict[str, ColumnKind], largest: dict[str, tuple[float, str]]
) -> tuple[Columns, dict[str, Array]]:
    """Return a table whose column s [m] grows, and its numbers as arrays.

    Parameters
    ----------
    path
        The file.
    known
        Columns that it may have, s among them.
    largest
        Magnitude in SI beyond which a value is taken for one in the wrong unit, by column, and
        what it is called.

    Raises
    ------
    InputError
        If it cannot be read or its numbers are none of a track; with lines and columns.
    """
    columns = read_columns(path, known)
    values = {name: np.array(numbers) for name, numbers in columns.numbers.items()}
    problems = [*_order(columns, values["s"])]
    for name, numbers in values.items():
        if np.isnan(numbers).any():
            row = int(np.flatnonzero(np.isnan(numbers))[0])
            problems.append(columns.problem(row, name, "the value is missing"))
        elif name in largest and (np.abs(numbers) > largest[name][0]).any():
            row = int(np.flatnonzero(np.abs(numbers) > largest[name][0])[0])
            words = f"{numbers[row]:g} {known[name].unit} is too much for {largest[name][1]}"
            problems.append(columns.problem(row, name, f"{words}; is the unit in the head right?"))
    if problems:
        raise refusal(problems, str(path))
    return columns, values


def _order(columns: Columns, s: Array) -> list[Problem]:
    if len(s) < 2:
        return [columns.problem(0, "s", "a track needs two lines at least")]
    if (np.abs(s) > FARTHEST).any():
        row = int(np.argmax(np.abs(s)))
        words = f"{s[row]:g} m is farther than a track begins or ends, {FARTHEST:g} m"
        return [columns.problem(row, "s", f"{words}; is the unit in the head right?")]
    steps = np.diff(s)
    if not (steps > 0.0).all():
        row = int(np.flatnonzero(~(steps > 0.0))[0]) + 1
        same = steps[row - 1] == 0.0
        words = "the place is there twice" if same else f"{s[row]:g} m comes after {s[row - 1]:g} m"
        return [columns.problem(row, "s", f"{words}; sort the lines by s")]
    usual = float(np.median(steps))
    if (steps > WIDEST_GAP * usual).any():
        row = int(np.argmax(steps)) + 1
        words = (
            f"a gap of {steps[row - 1]:g} m before this line, where others are {usual:g} m apart"
        )
        return [columns.problem(row, "s", words)]
    return []
