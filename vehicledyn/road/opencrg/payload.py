"""Data of OpenCRG files: records of numbers, as text or as big-endian binary."""

from __future__ import annotations

import re
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.problems import Mark, Problem
from vehicledyn.road.opencrg.header import Header

Array: TypeAlias = NDArray[np.float64]
Indices: TypeAlias = NDArray[np.intp]
Flags: TypeAlias = NDArray[np.bool_]
_RECORD = 80
_NUMBER = re.compile(rb" *[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)? *")


class PayloadError(ValueError):
    """Data that cannot be read; ``problem`` says where and why."""

    def __init__(self, problem: Problem) -> None:
        super().__init__(str(problem))
        self.problem = problem


def read_payload(content: bytes, header: Header, rows: int | None) -> Array:
    """Return the data as shape (rows, channels); NaN where a value is missing.

    Parameters
    ----------
    content
        The whole file.
    header
        Its header.
    rows
        Rows that the reference line says, or None; binary records beyond them are padding.

    Raises
    ------
    PayloadError
        If a record is cut short or holds no numbers.
    """
    data = content[header.size :]
    read = _text if header.code[2] == "F" else _binary
    return read(data, header, rows)


def _binary(data: bytes, header: Header, rows: int | None) -> Array:
    kind = np.dtype(">f8" if header.code[1] == "D" else ">f4")
    count = len(header.channels)
    found = len(data) // (kind.itemsize * count)
    _require(found, rows, header)
    whole = found if rows is None else rows
    numbers = np.frombuffer(data, kind, whole * count).reshape(whole, count)
    with np.errstate(invalid="ignore"):  # missing values may be signalling NaN
        return numbers.astype(float)


def _require(found: int, rows: int | None, header: Header) -> None:
    """Refuse data with fewer cross sections than the header announces."""
    if rows is not None and found < rows:
        words = f"{rows} cross sections are announced, the file holds {found}: it is cut short"
        raise PayloadError(Problem(header.source, Mark(header.line_count + 1, 1), "", words))


def _text(data: bytes, header: Header, rows: int | None) -> Array:
    width = 20 if header.code[1] == "D" else 10
    each = _RECORD // width
    count = len(header.channels)
    per_row = -(-count // each)
    lines = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n").split(b"\n")
    kept = [(at, line) for at, line in enumerate(lines, header.line_count + 1) if line.strip()]
    if len(kept) % per_row:
        words = f"the last cross section has {len(kept) % per_row} of its {per_row} lines"
        raise PayloadError(Problem(header.source, Mark(kept[-1][0], 1), "", words))
    _require(len(kept) // per_row, rows, header)
    values = []
    for index, (at, line) in enumerate(kept):
        wanted = min(each, count - (index % per_row) * each)
        for cell in range(wanted):
            values.append(_cell(line[cell * width : (cell + 1) * width], header, at, cell * width))
    return np.array(values, dtype=float).reshape(-1, count)


def _cell(text: bytes, header: Header, line: int, column: int) -> float:
    """Return the number in a cell; NaN for a missing one, zero for an unused one."""
    if text.strip().startswith(b"*"):
        return 0.0 if text == b"**unused**" else float("nan")
    if text.strip().lower() == b"nan":
        return float("nan")
    if not _NUMBER.fullmatch(text):
        shown = text.decode("latin-1").strip()
        words = f"'{shown}' is no number" if shown else "the line ends before all its numbers"
        raise PayloadError(Problem(header.source, Mark(line, column + 1), "", words))
    return float(text.lower().replace(b"d", b"e"))
