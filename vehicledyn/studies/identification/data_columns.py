"""Columns of measured data, whatever file they come from: values, units and gaps."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.base.units import Unit, parse_unit

Floats = NDArray[np.float64]

MOST_VALUES = 20_000_000
"""Values of the longest column that is read."""

_MATRIX = re.compile(r"(.+)\(:, ?(\d{1,6})\)")
_BRACKETS = re.compile(r"[\[(]([^][()]*)[\])]")


class DataColumn(NamedTuple):
    """A column of a file: ``values`` (n,), real or complex, with gaps that are not a number.

    ``unit`` is what the file states, None if it states none. ``times`` (n,) [s] are its own where
    the file has them beside each column, ``lines`` (n,) those of a text.
    """

    name: str
    values: NDArray[Any]
    unit: str | None = None
    times: Floats | None = None
    lines: Sequence[int] = ()

    def place(self, path: Path | str, row: int) -> str:
        """Return where in the file a value stands."""
        return f"{path}:{self.lines[row]}" if self.lines else f"{path}: row {row + 1}"


def clean_unit(text: object) -> str | None:
    """Return a unit as a program wrote it, without brackets; None if it is empty or None.

    Examples
    --------
    >>> clean_unit("[mm]"), clean_unit(b"-"), clean_unit("")
    ('mm', '1', None)
    """
    if text is None:
        return None
    words = text.decode("utf-8", "replace") if isinstance(text, bytes) else str(text)
    words = words.strip().strip("\0")
    match = _BRACKETS.fullmatch(words)
    words = words if match is None else match[1].strip()
    return "1" if words == "-" else words or None


def chosen_unit(path: Path | str, column: DataColumn, given: object, key: str = "unit") -> str:
    """Return the unit of a column: that of the file, or the one given for it under a key.

    Raises
    ------
    InputError
        If there is none, or there are two.
    """
    about, stated = (column.name,), column.unit
    own, why = _parsed(stated)
    if given is None and stated is None:
        raise InputError(f"{path}: states no unit of '{column.name}'; give '{key}'", about=about)
    if given is None:
        if own is None:
            words = f"of '{column.name}' is unknown ({why}); give '{key}'"
            raise InputError(f"{path}: the unit {words}", about=about)
        return str(stated)
    wanted, why = _parsed(str(given))
    if wanted is None:
        raise InputError(f"{key}: {why}", about=about)
    if own is not None and own != wanted:
        words = f"states that '{column.name}' is in '{stated}'; leave '{key}' out"
        raise InputError(f"{path}: {words}", about=about)
    return str(given)


def in_si(
    path: Path | str, column: DataColumn, given: object, unit: str, key: str = "unit"
) -> Floats:
    """Return the values of a column in SI.

    Parameters
    ----------
    path
        The file, or what the values were given as.
    column
        The column.
    given
        Its unit if the file states none.
    unit
        SI unit of what it measures.
    key
        Under which key the unit is given.

    Raises
    ------
    InputError
        If the unit does not fit, or the values are complex.
    """
    if np.iscomplexobj(column.values):
        words = f"'{column.name}' holds complex numbers, of which this takes none"
        raise InputError(f"{path}: {words}", about=(column.name,))
    text = chosen_unit(path, column, given, key)
    own = parse_unit(text)
    if own.dimension != parse_unit(unit).dimension:
        words = f"'{column.name}': the unit '{text}' does not measure a quantity in {unit}"
        raise InputError(f"{path}: {words}", about=(column.name,))
    return np.asarray(column.values, dtype=float) * own.factor


def numbers_of(path: Path | str, name: str, values: Any) -> NDArray[Any]:
    """Return an array of a file as the numbers of a column, those of a matrix by ``name(:, 2)``.

    Raises
    ------
    InputError
        If it is no row or column of numbers.
    """
    array = np.asarray(values)
    if array.dtype.kind == "O":
        array = _plain(array)
    if array.dtype.kind not in "fiubc":
        raise InputError(f"{path}: '{name}' holds no numbers", about=(name,))
    if array.size > MOST_VALUES:
        words = f"'{name}' has {array.size} values; at most {MOST_VALUES} are read"
        raise InputError(f"{path}: {words}", about=(name,))
    match = _MATRIX.fullmatch(name)
    if match is not None and array.ndim == 2:
        if not 1 <= int(match[2]) <= array.shape[1]:
            words = f"'{match[1]}' has the columns 1 to {array.shape[1]}"
            raise InputError(f"{path}: {words}", about=(name,))
        array = array[:, int(match[2]) - 1]
    if sum(length != 1 for length in array.shape) > 1 or (match and array.ndim != 1):
        words = f"'{name}' is no row or column of numbers; its shape is {array.shape}"
        hint = f"; take one column of it, such as '{name}(:,1)'" if array.ndim == 2 else ""
        raise InputError(f"{path}: {words}{hint}", about=(name,))
    kind = complex if array.dtype.kind == "c" else float
    return np.atleast_1d(array.astype(kind).reshape(-1))


def matrix_of(name: str) -> str:
    """Return the name of the matrix that a column is taken from, or the name itself.

    Examples
    --------
    >>> matrix_of("bench(:,2)"), matrix_of("height")
    ('bench', 'height')
    """
    match = _MATRIX.fullmatch(name)
    return name if match is None else match[1]


def no_column(path: Path, name: str, known: Iterable[str]) -> InputError:
    """Return the error that a file has no column of a name, with the nearest that it has."""
    guess = nearest_name(name, list(known))
    hint = f"; did you mean '{guess}'?" if guess else ""
    return InputError(f"{path}: has no column '{name}'{hint}", about=(name,))


def _parsed(text: str | None) -> tuple[Unit | None, str]:
    """Return a unit, None and why if a text names none."""
    if text is None:
        return None, ""
    try:
        return parse_unit(text), ""
    except InputError as error:
        return None, str(error)


def _plain(array: NDArray[Any]) -> NDArray[Any]:
    """Return objects that are numbers as an array of them, others as they are."""
    try:
        return array.astype(float)
    except (TypeError, ValueError):
        return array
