"""Values and derivatives of many functions at many points, compiled, in SIMD lanes.

Either a lane carries a point and a direction, and the code is that of one directional derivative:
three times the size of the values alone, quickly compiled. Or it carries a point, and the code is
that of the whole Jacobian: larger, but several times faster where there are many variables, since
most elements are zero and the others have much in common.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.solve import cache
from vehicledyn.solve.code import print_function
from vehicledyn.solve.compiler import build_library, find_compiler, suitable_lanes
from vehicledyn.solve.engine import Vector
from vehicledyn.solve.fingerprint import function_text, generator_fingerprint
from vehicledyn.solve.functions import apart_from_parameters
from vehicledyn.solve.source import shared_source
from vehicledyn.solve.table_rows import ROW, TableRows
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
        self._function, self._flow = _compiled(wanted)

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
        assert self._flow is not None
        before = [a.ctypes.data for a in (*given, sizes)]
        after = [a.ctypes.data for a in (ends, maps, first, last, errors)]
        if self._flow(count, *before, tolerance, trials, *after):
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

    @property
    def carries_motion(self) -> bool:
        """Whether the values are rates of the point, whose whole Jacobian is at hand."""
        square = self.values.shape[0] == self.point.shape[0]
        return self.often and self.index is not None and bool(square)

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
        parts = [
            f"#define VD_LANES {lanes}",
            shared_source("real.h"),
            shared_source("elementary.c"),
            *(f"#define {name} {size}" for name, size in sizes.items()),
            "" if pattern is None else _places(pattern),
            print_function(prepare, "prepare", ["p"], tables=self.tables),
            print_function(evaluate, "evaluate", names, tables=self.tables),
            shared_source("slopes.c"),
            shared_source("flow.c") if self.carries_motion and pattern is not None else "",
        ]
        return "\n".join(parts)


def _places(pattern: Any) -> str:
    """Return the C text of where the nonzeros of a Jacobian lie in one stored by columns."""
    rows, columns = pattern.size1(), pattern.get_col()
    places = [column * rows + row for row, column in zip(pattern.row(), columns, strict=True)]
    return f"static const int place[] = {{{', '.join(map(str, places)) or '0'}}};"


def _compiled(wanted: _Wanted) -> tuple[Callable[..., None], Callable[..., int] | None]:
    """Return the function of values and slopes, and that which carries motions if there is one."""
    compiler, lanes = find_compiler(), suitable_lanes()

    def build(folder: Path) -> Path:
        return build_library(compiler, wanted.text(lanes), folder)

    def opened(path: Path) -> tuple[Callable[..., None], Callable[..., int] | None]:
        library = ctypes.CDLL(str(path))
        return library.vd_points, library.vd_flow if wanted.carries_motion else None

    key = wanted.key(f"{lanes} lanes", generator_fingerprint(), compiler.identity)
    (points, flow), _ = cache.load(key, build, opened)
    number = ctypes.c_longlong
    points.restype, points.argtypes = None, [number, *[_P] * 4]  # type: ignore[attr-defined]
    if flow is not None:
        flow.restype = number  # type: ignore[attr-defined]
        flow.argtypes = [number, *[_P] * 4, ctypes.c_double, number, *[_P] * 5]  # type: ignore[attr-defined]
    return points, flow
