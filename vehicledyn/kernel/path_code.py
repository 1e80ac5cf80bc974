"""Machine code that follows one motion, and the nodes of the path that it finds."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.codegen.ir.table_rows import TableRows
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.point_source import Wanted, compiled
from vehicledyn.symbolic.tables import CurveTable

_FIRST_ROOM, _MOST_ROOM = 4096, 65_536
"""Steps for which there is room at first, and at last."""


@dataclass(frozen=True)
class StepTrace:
    """A motion through a row of durations, as the steps found it.

    ``nodes`` (n_steps + 1, n) are the states between the steps and ``rates`` those there, ``sizes``
    (n_steps,) the sizes of the steps [s]; ``steps`` (n_durations,) of them lie in each duration.
    ``error`` is what they were allowed, part of the scales.
    """

    nodes: Vector
    rates: Vector
    sizes: Vector
    steps: NDArray[np.int64]
    error: float

    @property
    def times(self) -> Vector:
        """When the steps begin, shape (n_steps,) [s]."""
        return np.concatenate([[0.0], np.cumsum(self.sizes)[:-1]])

    @property
    def begins(self) -> NDArray[np.int64]:
        """Numbers of the nodes at which durations begin, shape (n_durations,)."""
        return np.concatenate([[0], np.cumsum(self.steps)[:-1]])

    @property
    def places(self) -> Vector:
        """States at the end of each duration, shape (n_durations, n)."""
        return np.asarray(self.nodes[np.cumsum(self.steps)])


class PathCode:
    """Machine code that follows one motion.

    Parameters
    ----------
    rates
        Rates of the point, shape (n,).
    point
        Symbols of the point, shape (n,).
    parameter
        Symbols of the parameters, shape (n_parameters,).
    tables
        All that the rates look up.

    Raises
    ------
    CompilationError
        If there is no compiler, or it fails.
    """

    def __init__(
        self, rates: Any, point: Any, parameter: Any, tables: tuple[CurveTable, ...]
    ) -> None:
        """Print and compile, or take the code from the cache."""
        self._rows = TableRows(tables)
        self._library = compiled(Wanted(rates, point, parameter, tables, None, False), 1)
        self._room = _FIRST_ROOM

    def followed(
        self,
        begin: Vector,
        parameters: Vector,
        durations: Vector,
        *,
        scales: Vector,
        tolerance: float,
        trials: int,
    ) -> StepTrace | None:
        """Return the path of a motion through durations [s], shape (n_durations,).

        Steps have errors of at most the tolerance times ``scales``; None where they become more
        than ``trials``, or too many to be kept.
        """
        given = [np.ascontiguousarray(a, dtype=float) for a in (begin, durations, scales)]
        numbers = self._rows.after(np.ascontiguousarray(parameters, dtype=float))
        before = [a.ctypes.data for a in (given[0], numbers, *given[1:])]
        count, n = len(durations), len(begin)
        while True:
            room = min(self._room, trials)
            nodes, rates = np.empty((room + 1, n)), np.empty((room + 1, n))
            sizes, steps = np.empty(room), np.empty(count, np.int64)
            after = [a.ctypes.data for a in (nodes, rates, sizes, steps)]
            left = self._library.vd_march(count, *before, tolerance, trials, room, *after)
            taken = int(steps.sum())
            if not left:
                kept = nodes[: taken + 1].copy(), rates[: taken + 1].copy(), sizes[:taken].copy()
                return StepTrace(*kept, steps, tolerance)
            if taken < room or room >= min(trials, _MOST_ROOM):
                return None
            self._room *= 4
