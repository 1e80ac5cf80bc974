"""Values and derivatives of many equations at many points, compiled, in SIMD lanes.

A lane carries a point and a direction, so the code is that of one directional derivative: three
times the size of the values alone, however many variables there are.
"""

from __future__ import annotations

import ctypes
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.solve import cache
from vehicledyn.solve.code import print_function
from vehicledyn.solve.compiler import CompilationError, build_library, find_compiler
from vehicledyn.solve.engine import Vector
from vehicledyn.solve.fingerprint import function_text, generator_fingerprint
from vehicledyn.solve.functions import apart_from_parameters
from vehicledyn.solve.lanes import suitable_lanes
from vehicledyn.solve.source import shared_source
from vehicledyn.solve.table_rows import ROW, TableRows
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.tables import CurveTable

_P = ctypes.c_void_p


class PointSlopes:
    """Machine code of values, a column of functions of a point and the parameters.

    Parameters
    ----------
    values
        The functions, shape (n_values,).
    point
        Symbols that differ from point to point, shape (n,).
    parameter, index
        Symbols of the parameters, and which of them the values are differentiated by too.
    tables
        All that the values look up.

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
        index: int,
        tables: tuple[CurveTable, ...],
    ) -> None:
        """Derive, print and compile, or take the code from the cache."""
        self._sizes = (point.shape[0], values.shape[0])
        self._rows = TableRows(tables)
        moving = ops.stacked(point, parameter[index])
        direction = ops.symbols("direction", moving.shape[0])
        slopes = ops.derivative(values, moving, direction)
        inputs = [point, direction, parameter]
        prepare, evaluate = apart_from_parameters(inputs, [values, slopes])
        lanes = suitable_lanes()
        texts = [function_text(item, tables) for item in (prepare, evaluate)]
        compiler = find_compiler()
        key = cache.key_of(*texts, f"{lanes} lanes", generator_fingerprint(), compiler.identity)

        def build(folder: Path) -> Path:
            sizes = {
                "NP": parameter.shape[0],
                "NC": prepare.numel_out(0),
                "NT": ROW * len(tables),
                "NPOINT": point.shape[0],
                "NROW": values.shape[0],
            }
            parts = [
                f"#define VD_LANES {lanes}",
                shared_source("real.h"),
                shared_source("elementary.c"),
                *(f"#define {name} {size}" for name, size in sizes.items()),
                print_function(prepare, "prepare", ["p"], tables=tables),
                print_function(evaluate, "evaluate", ["x", "d", "c"], tables=tables),
                shared_source("slopes.c"),
            ]
            return build_library(compiler, "\n".join(parts), folder)

        entry = cache.obtain(key, build)
        try:
            self._function = ctypes.CDLL(str(entry.path)).vd_slopes
        except (OSError, AttributeError) as error:
            cache.discard(entry)
            raise CompilationError(f"the compiled library cannot be loaded ({error})") from None
        finally:
            if entry.temporary is not None:
                entry.temporary.cleanup()
        self._function.restype = None
        self._function.argtypes = [ctypes.c_longlong, _P, _P, _P, _P]

    def __call__(self, points: Vector, parameters: Vector) -> tuple[Vector, Vector]:
        """Return values (count, n_values) and slopes (count, n_values, n + 1).

        Points have the shape (count, n); the last column of slopes is that by the parameter.
        """
        n, rows = self._sizes
        count = len(points)
        given = np.ascontiguousarray(points, dtype=float)
        numbers = self._rows.after(np.ascontiguousarray(parameters, dtype=float))
        values, slopes = np.empty((count, rows)), np.empty((count, n + 1, rows))
        arrays = [item.ctypes.data for item in (given, numbers, values, slopes)]
        self._function(count, *arrays)
        return values, slopes.transpose(0, 2, 1)
