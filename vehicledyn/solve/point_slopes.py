"""Values and derivatives of many functions at many points, compiled, in SIMD lanes.

A lane carries a point and a direction, so the code is that of one directional derivative: three
times the size of the values alone, however many variables there are.
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
from vehicledyn.symbolic.tables import CurveTable

_P = ctypes.c_void_p


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
    ) -> None:
        """Derive, print and compile, or take the code from the cache."""
        self._rows = TableRows(tables)
        inputs, results = [point, parameter], [values]
        if index is not None:
            moving = ops.stacked(point, parameter[index])
            direction = ops.symbols("direction", moving.shape[0])
            results.append(ops.derivative(values, moving, direction))
            inputs.insert(1, direction)
        prepare, evaluate = apart_from_parameters(inputs, results)
        self._sizes = {
            "NP": parameter.shape[0],
            "NC": prepare.numel_out(0),
            "NT": ROW * len(tables),
            "NPOINT": point.shape[0],
            "NROW": values.shape[0],
            "NDIRECTION": 0 if index is None else point.shape[0] + 1,
        }
        self._function = _compiled(_Source(prepare, evaluate, self._sizes, tables))

    def values(self, points: Vector, parameters: Vector) -> Vector:
        """Return the values at points (count, n), shape (count, n_values)."""
        return self._at(points, parameters)[0]

    def slopes(self, points: Vector, parameters: Vector) -> tuple[Vector, Vector]:
        """Return values (count, n_values) and derivatives (count, n_values, n + 1).

        Points have the shape (count, n); the last derivative is that by the parameter.
        """
        values, slopes = self._at(points, parameters)
        return values, slopes.transpose(0, 2, 1)

    def _at(self, points: Vector, parameters: Vector) -> tuple[Vector, Vector]:
        count, n_values = len(points), self._sizes["NROW"]
        given = np.ascontiguousarray(points, dtype=float)
        numbers = self._rows.after(np.ascontiguousarray(parameters, dtype=float))
        values = np.empty((count, n_values))
        slopes = np.empty((count, self._sizes["NDIRECTION"], n_values))
        self._function(count, *[a.ctypes.data for a in (given, numbers, values, slopes)])
        return values, slopes


@dataclass(frozen=True)
class _Source:
    """What is compiled: the two functions, the sizes that slopes.c asks for and the tables."""

    prepare: Any
    evaluate: Any
    sizes: dict[str, int]
    tables: tuple[CurveTable, ...]

    def key(self, *further: str) -> str:
        texts = [function_text(item, self.tables) for item in (self.prepare, self.evaluate)]
        return cache.key_of(*texts, repr(self.sizes), *further)

    def text(self, lanes: int) -> str:
        names = [f"i{k}" for k in range(self.evaluate.n_in())]
        parts = [
            f"#define VD_LANES {lanes}",
            shared_source("real.h"),
            shared_source("elementary.c"),
            *(f"#define {name} {size}" for name, size in self.sizes.items()),
            print_function(self.prepare, "prepare", ["p"], tables=self.tables),
            print_function(self.evaluate, "evaluate", names, tables=self.tables),
            shared_source("slopes.c"),
        ]
        return "\n".join(parts)


def _compiled(source: _Source) -> Callable[..., None]:
    compiler, lanes = find_compiler(), suitable_lanes()

    def build(folder: Path) -> Path:
        return build_library(compiler, source.text(lanes), folder)

    key = source.key(f"{lanes} lanes", generator_fingerprint(), compiler.identity)
    function, _ = cache.load(key, build, lambda path: ctypes.CDLL(str(path)).vd_points)
    function.restype = None
    function.argtypes = [ctypes.c_longlong, _P, _P, _P, _P]
    return function
