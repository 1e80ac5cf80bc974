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
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.base.processors import cores
from vehicledyn.solve import cache
from vehicledyn.solve.code import print_function
from vehicledyn.solve.compiler import UNIT_BREAK, build_library, find_compiler, suitable_lanes
from vehicledyn.solve.engine import Vector
from vehicledyn.solve.fingerprint import function_text, generator_fingerprint
from vehicledyn.solve.functions import apart_from_parameters
from vehicledyn.solve.source import shared_source, wide_units
from vehicledyn.solve.table_rows import ROW, TableRows
from vehicledyn.solve.wide_functions import WideFunctions
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.chain_rule import entries_of, values_and_jacobian
from vehicledyn.symbolic.tables import CurveTable

_P = ctypes.c_void_p


@dataclass(frozen=True)
class Carried:
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
    ) -> None:
        """Derive, print and compile, or take the code from the cache."""
        self._rows = TableRows(tables)
        self._n_values = values.shape[0]
        self._n_directions = 0 if index is None else point.shape[0] + 1
        wanted = _Wanted(values, point, parameter, tables, index, often)
        self._lanes = suitable_lanes()
        self._function, self._flow = _compiled(wanted, self._lanes)

    def values(self, points: Vector, parameters: Vector) -> Vector:
        """Return the values at points (count, n), shape (count, n_values)."""
        return self._at(points, parameters)[0]

    def slopes(self, points: Vector, parameters: Vector) -> tuple[Vector, Vector]:
        """Return values (count, n_values) and derivatives (count, n_values, n + 1).

        Points have the shape (count, n); the last derivative is that by the parameter.
        """
        values, slopes = self._at(points, parameters)
        return values, slopes.transpose(0, 2, 1)

    @property
    def carries_motion(self) -> bool:
        """Whether the values are rates along which points can be carried."""
        return self._flow is not None

    def carried(
        self,
        points: Vector,
        parameters: Vector,
        durations: Vector,
        *,
        scales: Vector,
        tolerance: float,
        trials: int,
    ) -> Carried | None:
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
        flow = self._flow
        assert flow is not None

        def carry(begin: int) -> int:
            part = slice(begin, begin + self._lanes)
            before = [a.ctypes.data for a in (given[0][part], given[1], given[2][part], sizes)]
            after = [a[part].ctypes.data for a in (ends, maps, first, last, errors)]
            return flow(len(ends[part]), *before, tolerance, trials, *after)

        with ThreadPoolExecutor(cores()) as side_by_side:
            if any(side_by_side.map(carry, reversed(range(0, count, self._lanes)))):
                return None
        return Carried(ends, maps, first, last, errors)

    def _at(self, points: Vector, parameters: Vector) -> tuple[Vector, Vector]:
        count = len(points)
        given = np.ascontiguousarray(points, dtype=float)
        numbers = self._rows.after(np.ascontiguousarray(parameters, dtype=float))
        values = np.empty((count, self._n_values))
        slopes = np.empty((count, self._n_directions, self._n_values))
        self._function(count, *[a.ctypes.data for a in (given, numbers, values, slopes)])
        return values, slopes


@dataclass(frozen=True)
class _Wanted:
    """What is compiled, see :class:`PointCode`."""

    values: Any
    point: Any
    parameter: Any
    tables: tuple[CurveTable, ...]
    index: int | None
    often: bool

    def motion(self, lanes: int) -> str:
        """Return the file of the function that follows motions, where values are rates."""
        if self.values.shape[0] != self.point.shape[0]:
            return ""
        if self.index is None:
            return "march.c" if lanes == 1 else ""
        return "flow.c" if self.often else ""

    def key(self, *further: str) -> str:
        """Return a text that tells all that the code depends on."""
        import casadi

        function = casadi.Function("values", [self.point, self.parameter], [self.values])
        texts = [function_text(function, self.tables), repr((self.index, self.often))]
        return cache.key_of(*texts, *further)

    def text(self, lanes: int) -> str:
        """Return the C source."""
        inputs, results, pattern = [self.point, self.parameter], [self.values], None
        if self.index is not None:
            moving = ops.stacked(self.point, self.parameter[self.index])
            if self.often:
                values, slopes = values_and_jacobian(self.values, moving)
                pattern = slopes.sparsity()
                results = [values, entries_of(slopes)]
            else:
                direction = ops.symbols("direction", moving.shape[0])
                results.append(ops.derivative(self.values, moving, direction))
                inputs.insert(1, direction)
        prepare, evaluate = apart_from_parameters(inputs, results)
        sizes = {
            "NP": self.parameter.shape[0],
            "NC": prepare.numel_out(0),
            "NT": ROW * len(self.tables),
            "NPOINT": self.point.shape[0],
            "NROW": self.values.shape[0],
            "NDIRECTION": 0 if self.index is None else self.point.shape[0] + 1,
            "NENTRY": 0 if pattern is None else pattern.nnz(),
        }
        names = [f"i{k}" for k in range(evaluate.n_in())]
        wide = WideFunctions(suitable_lanes()) if lanes == 1 else None
        parts = [
            f"#define VD_LANES {lanes}",
            shared_source("real.h"),
            shared_source("elementary.c"),
            *(f"#define {name} {size}" for name, size in sizes.items()),
            "" if pattern is None else _places(pattern),
            print_function(prepare, "prepare", ["p"], tables=self.tables),
            print_function(evaluate, "evaluate", names, tables=self.tables, wide=wide),
            shared_source("slopes.c"),
            shared_source(self.motion(lanes)) if self.motion(lanes) else "",
        ]
        return UNIT_BREAK.join(["\n".join(parts), *([] if wide is None else wide_units(wide))])


def _places(pattern: Any) -> str:
    """Return the C text of where the nonzeros of a Jacobian lie in one stored by columns."""
    rows, columns = pattern.size1(), pattern.get_col()
    places = [column * rows + row for row, column in zip(pattern.row(), columns, strict=True)]
    return f"static const int place[] = {{{', '.join(map(str, places)) or '0'}}};"


class PathCode:
    """Machine code that follows one motion; ``rates`` are those of the point.

    The other parameters and errors are those of :class:`PointCode`.
    """

    def __init__(
        self, rates: Any, point: Any, parameter: Any, tables: tuple[CurveTable, ...]
    ) -> None:
        """Print and compile, or take the code from the cache."""
        self._rows = TableRows(tables)
        _, self._march = _compiled(_Wanted(rates, point, parameter, tables, None, False), 1)

    def followed(
        self,
        begin: Vector,
        parameters: Vector,
        durations: Vector,
        *,
        scales: Vector,
        tolerance: float,
        trials: int,
    ) -> tuple[Vector, Vector] | None:
        """Return the states at the end of each duration [s], shape (n_durations, n), and efforts.

        Steps have errors of at most the tolerance times ``scales``; None where they become more
        than ``trials``. Efforts (n_durations,) are the steps tried.
        """
        given = [np.ascontiguousarray(a, dtype=float) for a in (begin, durations, scales)]
        numbers = self._rows.after(np.ascontiguousarray(parameters, dtype=float))
        places, efforts = np.empty((len(durations), len(begin))), np.empty(len(durations))
        addresses = [a.ctypes.data for a in (given[0], numbers, *given[1:])]
        assert self._march is not None
        found = places.ctypes.data, efforts.ctypes.data
        left = self._march(len(durations), *addresses, tolerance, trials, *found)
        return None if left else (places, efforts)


def _compiled(wanted: _Wanted, lanes: int) -> tuple[Callable[..., None], Callable[..., int] | None]:
    """Return the function of values and slopes, and that of motions if there is one."""
    compiler = find_compiler()

    def build(folder: Path) -> Path:
        return build_library(compiler, wanted.text(lanes), folder)

    def opened(path: Path) -> tuple[Callable[..., None], Callable[..., int] | None]:
        library = ctypes.CDLL(str(path))
        motion = {"": None, "flow.c": "vd_flow", "march.c": "vd_march"}[wanted.motion(lanes)]
        return library.vd_points, None if motion is None else getattr(library, motion)

    key = wanted.key(f"{lanes} lanes", generator_fingerprint(), compiler.identity)
    (points, flow), _ = cache.load(key, build, opened)
    number = ctypes.c_longlong
    points.restype, points.argtypes = None, [number, *[_P] * 4]  # type: ignore[attr-defined]
    if flow is not None:
        after = 5 if wanted.often else 2
        flow.restype = number  # type: ignore[attr-defined]
        arguments = [number, *[_P] * 4, ctypes.c_double, number, *[_P] * after]
        flow.argtypes = arguments  # type: ignore[attr-defined]
    return points, flow
