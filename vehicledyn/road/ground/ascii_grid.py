"""ESRI ASCII grids: heights in rows from north to south after a head of six lines."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.road.ground.height_grid import (
    HIGHEST,
    MOST_NODES,
    Array,
    HeightGrid,
    height_of,
    is_number,
    number_of,
    text_lines,
)

_HEAD = ("ncols", "nrows", "xllcorner", "yllcorner", "xllcenter", "yllcenter", "cellsize")
_NO_DATA = "nodata_value"


def read_ascii_grid(path: Path) -> HeightGrid:
    """Return the heights of an ESRI ASCII grid; rows run from north to south.

    Raises
    ------
    InputError
        If the head or a number is missing or wrong, or a height is; with the line.
    """
    lines = text_lines(path)
    head: dict[str, float] = {}
    for number, line in enumerate(lines, 1):
        words = line.split()
        if len(words) != 2 or words[0].lower() not in (*_HEAD, _NO_DATA):
            break
        key = words[0].lower()
        if key in head:
            raise InputError(f"{path}:{number}: {words[0]} is there twice")
        head[key] = number_of(path, number, words[1])
    missing = [key for key in ("ncols", "nrows", "cellsize") if key not in head]
    corner = [k for k in ("xll", "yll") if not {f"{k}corner", f"{k}center"} & head.keys()]
    if missing or corner:
        names = ", ".join(missing + [f"{k}corner" for k in corner])
        raise InputError(f"{path}: the head of an ESRI ASCII grid lacks {names}")
    columns, rows = (_count(path, key, head[key]) for key in ("ncols", "nrows"))
    if not (0.0 < head["cellsize"] <= 1e6):
        raise InputError(f"{path}: cellsize must be positive, found {head['cellsize']:g}")
    if columns * rows > MOST_NODES:
        raise InputError(f"{path}: {columns * rows} nodes; {MOST_NODES} at most")
    heights = _heights(
        path, list(enumerate(lines, 1))[len(head) :], (rows, columns), head.get(_NO_DATA)
    )
    x, y = (
        head.get(f"{k}center", head.get(f"{k}corner", 0.0) + 0.5 * head["cellsize"])
        for k in ("xll", "yll")
    )
    return HeightGrid(x, y, head["cellsize"], heights[::-1].T.copy())


def _heights(
    path: Path, lines: list[tuple[int, str]], shape: tuple[int, int], absent: float | None
) -> Array:
    found, (rows, columns) = np.empty(shape), shape
    row = 0
    for number, line in lines:
        words = line.split()
        if not words:
            continue
        if row == rows:
            raise InputError(f"{path}:{number}: more rows than nrows says, {rows}")
        if len(words) != columns:
            raise InputError(f"{path}:{number}: {len(words)} heights, ncols says {columns}")
        try:
            found[row] = [float(word) for word in words]
        except ValueError:
            wrong = next(word for word in words if not is_number(word))
            raise InputError(f"{path}:{number}: '{wrong[:40]}' is not a number") from None
        gap = ~np.isfinite(found[row]) | (found[row] == absent)
        if gap.any():
            raise InputError(
                f"{path}:{number}: no height in column {int(np.argmax(gap)) + 1}; fill the gaps "
                "of the grid first"
            )
        if np.abs(found[row]).max() > HIGHEST:
            height_of(path, number, max(words, key=lambda word: abs(float(word))))
        row += 1
    if row < rows:
        raise InputError(f"{path}: {row} rows of heights, nrows says {rows}")
    return found


def _count(path: Path, key: str, value: float) -> int:
    if not (2 <= value <= MOST_NODES and value == int(value)):
        raise InputError(f"{path}: {key} must be a whole number of at least 2, found {value:g}")
    return int(value)
