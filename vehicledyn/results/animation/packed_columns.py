"""Columns of numbers packed small for a page: rounded, differenced, deflated, in base64.

A column of n values becomes whole numbers k = round((value - low)/step) of two or four bytes, the
largest of which stands for what is not a number. Their differences, modulo 2^16 or 2^32, are laid
down byte by byte, all first bytes before all second ones, which deflates well for smooth motion.
"""

from __future__ import annotations

import base64
import zlib
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

_BYTES = {2: np.uint16, 4: np.uint32}


class PackedColumns:
    """Collects columns; ``describe`` and ``packed`` are what a page needs to read them again."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []
        self.describe: list[list[float]] = []
        """Of each column: length, bytes of a number (0 for a constant), low value, step."""

    def add(self, values: ArrayLike, *, finest: float = 0.0) -> int:
        """Add a column and return its number.

        Parameters
        ----------
        values
            Numbers, shape (n,).
        finest
            Step that two bytes must reach, else four are used; 0 for two bytes in any case.
        """
        column = np.asarray(values, dtype=float)
        known = column[np.isfinite(column)]
        low = float(known.min()) if len(known) else 0.0
        extent = float(known.max()) - low if len(known) else 0.0
        size = 4 if finest and extent / 65534 > finest else 2
        if len(known) == len(column) and extent == 0.0:
            self.describe.append([len(column), 0, low, 0.0])
            return len(self.describe) - 1
        largest = 256**size - 1
        step = extent / (largest - 1) or 1.0
        scaled = np.where(np.isfinite(column), (np.nan_to_num(column) - low) / step, largest)
        whole = np.clip(np.rint(scaled), 0, largest).astype(np.int64)
        differences = np.diff(whole, prepend=0) % (largest + 1)
        little = differences.astype(_BYTES[size]).astype(f"<u{size}")
        planes = little.view(np.uint8).reshape(-1, size).T
        self._parts.append(planes.tobytes())
        self.describe.append([len(column), size, low, step])
        return len(self.describe) - 1

    @property
    def packed(self) -> str:
        """All columns, one after the other, deflated (zlib) and in base64."""
        return base64.b64encode(zlib.compress(b"".join(self._parts), 6)).decode("ascii")


def unpack(describe: list[list[float]], packed: str) -> list[Any]:
    """Return the columns again, as arrays; what the page does in its own language."""
    data, place, columns = zlib.decompress(base64.b64decode(packed)), 0, []
    for length, size, low, step in describe:
        count, width = int(length), int(size)
        if width == 0:
            columns.append(np.full(count, low))
            continue
        planes = np.frombuffer(data, np.uint8, count * width, place).reshape(width, count)
        place += count * width
        powers = 256 ** np.arange(width, dtype=np.int64)
        whole = np.cumsum(powers @ planes.astype(np.int64)) % 256**width
        columns.append(np.where(whole == 256**width - 1, np.nan, low + whole * step))
    return columns
