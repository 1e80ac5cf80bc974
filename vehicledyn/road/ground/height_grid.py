"""Heights on a square grid, and what readers of them share."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.base.files.limits import read_regular

Array = NDArray[np.float64]

MOST_NODES = 4_000_000
"""Nodes of the largest grid."""

HIGHEST = 1e6
"""Height from which on it is none of a road [m]."""

_MOST_BYTES = 100 * 2**20


class HeightGrid(NamedTuple):
    """Heights [m], shape (n_x, n_y), of nodes from a place x, y on, step apart [m]."""

    x: float
    y: float
    step: float
    heights: Array


def text_lines(path: Path) -> list[str]:
    """Return the lines of a text file.

    Raises
    ------
    InputError
        If it cannot be read, is too large or is no text.
    """
    content = read_regular(path, _MOST_BYTES)
    if b"\0" in content:
        raise InputError(f"{path}: is not a text file")
    return content.decode("utf-8-sig", errors="replace").splitlines()


def number_of(path: Path, line: int, word: str) -> float:
    """Return a word of a line as a finite number; InputError with the line for others."""
    if not is_number(word):
        raise InputError(f"{path}:{line}: '{word[:40]}' is not a finite number")
    return float(word)


def height_of(path: Path, line: int, word: str) -> float:
    """Return a word of a line as a height [m]; InputError with the line for none of a road."""
    found = number_of(path, line, word)
    if abs(found) > HIGHEST:
        raise InputError(f"{path}:{line}: {found:g} m; no road is higher than {HIGHEST:g} m")
    return found


def is_number(word: str) -> bool:
    """Return whether a word is a finite number."""
    try:
        return bool(np.isfinite(float(word)))
    except ValueError:
        return False
