"""Numbers that belong to data and stay out of the generated code, as those of a table do.

Where a grid begins, how wide its cells are and how many there are differ from file to file. In
expressions they are entries of a table at a fixed place, which kernels look up once for each
parameter set, so code compiled for one grid serves every other one of the same kind.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import numpy as np

from vehicledyn.symbolic.tables import CurveTable

_FEWEST = 2
"""Coefficients that a table has at least."""


class RunTimeNumbers:
    """Numbers known at run time only.

    Parameters
    ----------
    name
        What they belong to, for messages.
    values
        The numbers, finite.
    """

    def __init__(self, name: str, values: Sequence[float]) -> None:
        self.values = [float(value) for value in values]
        row = [*self.values, *[0.0] * (_FEWEST - len(self.values))]
        self._table = CurveTable(name, 0.0, 1.0, np.array([row]))

    def at(self, *places: Any) -> list[Any]:
        """Return the numbers: plain beside plain places, else expressions that look them up."""
        if all(isinstance(place, int | float | np.number | np.ndarray) for place in places):
            return list(self.values)
        return self._entries

    @cached_property
    def _entries(self) -> list[Any]:
        """The numbers as expressions, which are the same ones wherever they are used."""
        return self._table.entries(0.0)[: len(self.values)]
