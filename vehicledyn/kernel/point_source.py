"""Print and compile functions of points, their slopes and the motions along them."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vehicledyn.codegen.ir.table_rows import ROW
from vehicledyn.codegen.passes.kernel_functions import apart_from_parameters
from vehicledyn.codegen.printers.c_printer import print_function
from vehicledyn.codegen.printers.kernel_source import shared_source, wide_units
from vehicledyn.codegen.printers.wide_functions import WideFunctions
from vehicledyn.codegen.toolchain import cache
from vehicledyn.codegen.toolchain.compiler import (
    UNIT_BREAK,
    build_library,
    find_compiler,
    suitable_lanes,
)
from vehicledyn.codegen.toolchain.fingerprint import function_text, generator_fingerprint
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.chain_rule import entries_of, values_and_jacobian
from vehicledyn.symbolic.tables import CurveTable

_D, _L, _P = ctypes.c_double, ctypes.c_longlong, ctypes.c_void_p
_Signature = tuple[Any, Sequence[Any]]
_POINTS: dict[str, _Signature] = {"vd_points": (None, [_L, *[_P] * 4])}
_OF_FILE: dict[str, dict[str, _Signature]] = {
    "march.c": {"vd_march": (_L, [_L, *[_P] * 4, _D, _L, _L, *[_P] * 4])},
    "flow.c": {"vd_flow": (_L, [_L, *[_P] * 4, _D, _L, *[_P] * 5])},
    "tangents.c": {
        "vd_entries": (None, [_L, *[_P] * 4]),
        "vd_missed": (_L, [_L, *[_P] * 6]),
        "vd_tangents": (_L, [_L, *[_P] * 6]),
    },
}


@dataclass(frozen=True)
class Wanted:
    """What is compiled: ``values`` as functions of a ``point`` and the parameters.

    With ``index`` of a parameter, their derivatives by the point and by that; ``often`` where so
    many are wanted that the code of the whole Jacobian pays. With ``first``, derivatives by so many
    variables of the point, which come first, and by no parameter.
    """

    values: Any
    point: Any
    parameter: Any
    tables: tuple[CurveTable, ...]
    index: int | None
    often: bool
    first: int = 0

    @property
    def moving(self) -> Any:
        """The variables by which the values are differentiated, a column, None for none."""
        if self.first:
            return self.point[: self.first]
        return None if self.index is None else ops.stacked(self.point, self.parameter[self.index])

    def motion(self, lanes: int) -> tuple[str, ...]:
        """Return the files of functions that follow motions, where values are rates."""
        if self.values.shape[0] != self.point.shape[0] or self.first:
            return ()
        if self.index is None:
            return ("march.c",) if lanes == 1 else ()
        return ("flow.c", "tangents.c") if self.often else ()

    def key(self, *further: str) -> str:
        """Return a text with all that the code depends on."""
        import casadi

        function = casadi.Function("values", [self.point, self.parameter], [self.values])
        texts = [function_text(function, self.tables), repr((self.index, self.often, self.first))]
        return cache.key_of(*texts, *further)

    def text(self, lanes: int) -> str:
        """Return the C source."""
        inputs, results, pattern = [self.point, self.parameter], [self.values], None
        moving = self.moving
        if moving is not None:
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
            "NDIRECTION": 0 if moving is None else moving.shape[0],
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
            *map(shared_source, self.motion(lanes)),
        ]
        return UNIT_BREAK.join(["\n".join(parts), *([] if wide is None else wide_units(wide))])


def _places(pattern: Any) -> str:
    """Return the C text of where the nonzeros of a Jacobian lie: by columns, and by rows.

    By rows those of the last column, that of the parameter, are apart.
    """
    rows, last = pattern.size1(), pattern.size2() - 1
    by_columns = list(zip(pattern.row(), pattern.get_col(), strict=True))
    by_rows = sorted((row, column, k) for k, (row, column) in enumerate(by_columns))
    of_point = [item for item in by_rows if item[1] < last]
    of_parameter = {row: k for row, column, k in by_rows if column == last}
    lists = {
        "place": [column * rows + row for row, column in by_columns],
        "first_of_row": [sum(item[0] < row for item in of_point) for row in range(rows + 1)],
        "column_of": [column for _, column, _ in of_point],
        "entry_of": [k for _, _, k in of_point],
        "by_parameter": [of_parameter.get(row, -1) for row in range(rows)],
    }
    return "\n".join(
        f"static const int {name}[] = {{{', '.join(map(str, items)) or '0'}}};"
        for name, items in lists.items()
    )


def compiled(wanted: Wanted, lanes: int) -> ctypes.CDLL:
    """Return the library of what is wanted, from the cache if it is there."""
    compiler = find_compiler()

    def build(folder: Path) -> Path:
        return build_library(compiler, wanted.text(lanes), folder)

    def opened(path: Path) -> ctypes.CDLL:
        library = ctypes.CDLL(str(path))
        for signatures in (_POINTS, *(_OF_FILE[name] for name in wanted.motion(lanes))):
            for name, (result, arguments) in signatures.items():
                function = getattr(library, name)
                function.restype, function.argtypes = result, arguments
        return library

    key = wanted.key(f"{lanes} lanes", generator_fingerprint(), compiler.identity)
    return cache.load(key, build, opened)[0]
