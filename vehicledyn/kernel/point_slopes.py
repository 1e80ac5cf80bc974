"""Values and derivatives of many functions at many points, compiled, in SIMD lanes.

Either a lane carries a point and a direction, and the code is that of one directional derivative:
three times the size of the values alone, quickly compiled. Or it carries a point, and the code is
that of the whole Jacobian: larger, but several times faster where there are many variables, since
most elements are zero and the others have much in common.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.processors import cores
from vehicledyn.codegen.ir.table_rows import TableRows
from vehicledyn.codegen.toolchain.compiler import suitable_lanes
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.point_source import Wanted, compiled
from vehicledyn.symbolic.tables import CurveTable

_LEAST_GROUPS = 8
"""Groups of points for which a thread pays."""


@dataclass(frozen=True)
class CarriedMotions:
    """Motions from some points: their ends and rates at both ends, shape (count, n).

    ``maps`` (count, n, n + 1) are the derivatives of the ends by the begin and the parameter,
    ``errors`` (count,) the largest part of the rates that a step missed.
    """

    ends: Vector
    maps: Vector
    first: Vector
    last: Vector
    errors: Vector


class PointCode:
    """Machine code of values, a column of functions of a point and the parameters.

    Parameters
    ----------
    values
        The functions, shape (n_values,).
    point
        Symbols that differ from point to point, shape (n,).
    parameter
        Symbols of the parameters, shape (n_parameters,).
    tables
        All that the values look up.
    index
        Parameter by which the values are differentiated, as they are by the point; None where no
        derivatives are wanted.
    often
        Whether the derivatives are wanted at so many points that the code of the whole Jacobian
        pays.
    first
        How many of the variables of a point the values are differentiated by, if not by all and a
        parameter; they come first.

    Raises
    ------
    CompilationError
        If there is no compiler, or it fails.
    """

    def __init__(
        self,
        values: Any,
        point: Any,
        parameter: Any,
        tables: tuple[CurveTable, ...],
        *,
        index: int | None = None,
        often: bool = False,
        first: int = 0,
    ) -> None:
        """Derive, print and compile, or take the code from the cache."""
        self._rows = TableRows(tables)
        self._n_values = values.shape[0]
        wanted = Wanted(values, point, parameter, tables, index, often, first)
        self._n_directions = 0 if wanted.moving is None else wanted.moving.shape[0]
        self._lanes = suitable_lanes()
        self._library = compiled(wanted, self._lanes)
        self.carries_motion = bool(wanted.motion(self._lanes))
        """Whether the values are rates along which points can be carried."""

    def values(self, points: Vector, parameters: Vector) -> Vector:
        """Return the values at points (count, n), shape (count, n_values)."""
        return self._at(points, parameters)[0]

    def slopes(self, points: Vector, parameters: Vector) -> tuple[Vector, Vector]:
        """Return values (count, n_values) and derivatives (count, n_values, n_directions).

        Points have the shape (count, n); the last derivative is that by the parameter, if any.
        """
        values, slopes = self._at(points, parameters)
        return values, slopes.transpose(0, 2, 1)

    def carried(
        self,
        points: Vector,
        parameters: Vector,
        durations: Vector,
        *,
        scales: Vector,
        tolerance: float,
        trials: int,
    ) -> CarriedMotions | None:
        """Return where motions lead for which the values are the rates of the point.

        Parameters
        ----------
        points
            Where they begin, shape (count, n).
        parameters
            All parameters.
        durations
            How long they last, shape (count,) [s].
        scales
            Sizes of the states, shape (n,).
        tolerance
            Part of the rates that those carried by the tangent of a step may miss at its end.
        trials
            Steps that a motion may try; None is returned where one needs more.
        """
        count, n = points.shape
        given = [np.ascontiguousarray(a, dtype=float) for a in (points, parameters, durations)]
        given[1] = self._rows.after(given[1])
        sizes = np.ascontiguousarray(scales, dtype=float)
        ends, first, last = (np.empty((count, n)) for _ in range(3))
        maps, errors = np.empty((count, n, n + 1)), np.empty(count)

        def carry(begin: int) -> int:
            part = slice(begin, begin + self._lanes)
            before = [a.ctypes.data for a in (given[0][part], given[1], given[2][part], sizes)]
            after = [a[part].ctypes.data for a in (ends, maps, first, last, errors)]
            return int(self._library.vd_flow(len(ends[part]), *before, tolerance, trials, *after))

        with ThreadPoolExecutor(cores()) as side_by_side:
            if any(side_by_side.map(carry, reversed(range(0, count, self._lanes)))):
                return None
        return CarriedMotions(ends, maps, first, last, errors)

    @property
    def n_entries(self) -> int:
        """Number of elements of the Jacobian that may differ from zero."""
        return int(ctypes.c_longlong.in_dll(self._library, "vd_n_entries").value)

    def entries(self, points: Vector, parameters: Vector, room: int = 0) -> tuple[Vector, Vector]:
        """Return values (count, n_values) at points and the elements of the Jacobian there.

        Those that may differ from zero, column by column, shape (count, n_entries). Behind both is
        ``room`` for more points. For values that are rates, as what follows.
        """
        count = len(points)
        given = np.ascontiguousarray(points, dtype=float)
        numbers = self._rows.after(np.ascontiguousarray(parameters, dtype=float))
        sizes = self._n_values, self.n_entries
        values, entries = (np.empty((count + room, n)) for n in sizes)
        each = self._each(count)

        def evaluate(first: int) -> None:
            part = slice(first, min(first + each, count))
            arrays = given[part], numbers, values[part], entries[part]
            self._library.vd_entries(len(arrays[0]), *[a.ctypes.data for a in arrays])

        _side_by_side(evaluate, range(0, count, each))
        return values, entries

    def missed(
        self,
        sizes: Vector,
        rows: NDArray[np.int64],
        values: Vector,
        entries: Vector,
        scales: Vector,
    ) -> Vector:
        """Return by how much rates carried through steps as tangents miss those at their ends.

        Part of the largest rate, shape (n_steps,). ``sizes`` (n_steps,) in s; ``rows`` (n_steps, 3)
        are those of ``values`` and ``entries``, see :meth:`entries`, at begin, middle and end of
        each step; -1 for a middle that is not known.
        """
        count, own_rows = len(sizes), np.ascontiguousarray(rows)
        errors, each = np.empty(count), self._each(count)
        shared = [a.ctypes.data for a in (values, entries, scales)]

        def find(first: int) -> None:
            part = slice(first, min(first + each, count))
            own = [a[part] for a in (sizes, own_rows, errors)]
            addresses = [a.ctypes.data for a in own]
            call = self._library.vd_missed
            self._done(call(len(own[0]), *addresses[:2], *shared, addresses[2]))

        _side_by_side(find, range(0, count, each))
        return errors

    def tangents(
        self,
        counts: NDArray[np.int64],
        sizes: Vector,
        rows: NDArray[np.int64],
        entries: Vector,
    ) -> Vector:
        """Return the derivatives of motions by their begins and the parameter.

        Shape (n_motions, n, n + 1). ``counts`` (n_motions,) say how many of the steps that lie
        behind each other belong to each; they are given as for :meth:`missed`.
        """
        lanes, n = self._lanes, self._n_values
        order = np.argsort(-counts, kind="stable")
        begins = np.cumsum(counts) - counts
        whole = begins[order], counts[order], np.empty((len(order), n, n + 1))
        fixed = [a.ctypes.data for a in (sizes, rows, entries)]

        def carry(first: int) -> None:
            own = [a[first : first + lanes] for a in whole]
            addresses = [a.ctypes.data for a in own]
            self._done(self._library.vd_tangents(len(own[0]), *addresses[:2], *fixed, addresses[2]))

        _side_by_side(carry, range(0, len(order), lanes))
        maps = np.empty_like(whole[2])
        maps[order] = whole[2]
        return maps

    def _each(self, count: int) -> int:
        """Return how many points of some a thread takes."""
        return self._lanes * max(_LEAST_GROUPS, -(-count // (self._lanes * cores())))

    def _done(self, failed: int) -> None:
        if failed:
            raise MemoryError

    def _at(self, points: Vector, parameters: Vector) -> tuple[Vector, Vector]:
        count = len(points)
        given = np.ascontiguousarray(points, dtype=float)
        numbers = self._rows.after(np.ascontiguousarray(parameters, dtype=float))
        values = np.empty((count, self._n_values))
        slopes = np.empty((count, self._n_directions, self._n_values))
        each = self._each(count) if self._n_directions < self._lanes else -(-count // cores())

        def evaluate(first: int) -> None:
            part = slice(first, min(first + each, count))
            arrays = given[part], numbers, values[part], slopes[part]
            self._library.vd_points(len(arrays[0]), *[a.ctypes.data for a in arrays])

        _side_by_side(evaluate, range(0, count, max(each, 1)))
        return values, slopes


def _side_by_side(call: Callable[[int], None], firsts: range) -> None:
    """Call a function on the cores of the processor; one call alone needs no thread."""
    if len(firsts) < 2:
        for first in firsts:
            call(first)
        return
    with ThreadPoolExecutor(cores()) as pool:
        list(pool.map(call, firsts))
