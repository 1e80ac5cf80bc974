"""What compiled code knows of tables: a row of numbers for each, behind the other constants.

A row holds the origin, 1 / step, the step, the number of the last cell and the address of the
cells, all as doubles, so each case in lanes or on a GPU can have curves of its own. An address
fills the fraction of a double between 1 and 2: a double that held nothing else would be so small
that a processor set to do without such numbers takes it for zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from vehicledyn.symbolic.tables import CurveTable

Vector: TypeAlias = NDArray[np.float64]

ROW = 5
"""Numbers of a table; their order is that of vd_cell, vd_knot and vd_entry in real.h."""

_ALIGNMENT = 64

_EXPONENT = np.uint64(0x3FF0000000000000)
"""Bits of the double 1.0, all above the fraction."""


class TableRows:
    """The rows of some tables; keeps the cells whose addresses they hold."""

    def __init__(self, tables: Sequence[CurveTable]) -> None:
        """Lay the cells out as processors like to load them."""
        self._cells = [_aligned(table.cells) for table in tables]
        self.numbers = np.zeros(ROW * len(tables))
        for k, (table, cells) in enumerate(zip(tables, self._cells, strict=True)):
            row = self.numbers[ROW * k : ROW * (k + 1)]
            row[:4] = table.origin, 1.0 / table.step, table.step, len(cells) - 1
            row[4:].view(np.uint64)[0] = np.uint64(cells.ctypes.data) | _EXPONENT

    def after(self, values: Vector) -> Vector:
        """Return a column of numbers with the rows behind it."""
        return np.concatenate([values, self.numbers])


def _aligned(array: Vector) -> Vector:
    raw = np.empty(array.size + _ALIGNMENT // 8)
    first = -(raw.ctypes.data // 8) % (_ALIGNMENT // 8)
    room = raw[first : first + array.size].reshape(array.shape)
    room[:] = array
    return room
