"""The engine that carries several cases side by side through compiled code."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.garbage import without_collection
from vehicledyn.codegen.ir.table_rows import TableRows
from vehicledyn.codegen.passes.kernel_functions import derive_functions
from vehicledyn.codegen.passes.seam_cut import cut_at_seam
from vehicledyn.codegen.printers.kernel_source import lane_source
from vehicledyn.codegen.toolchain import cache
from vehicledyn.codegen.toolchain.compiler import build_library, find_compiler
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.seam_library import seam_library
from vehicledyn.symbolic.equations import Equations

_D, _I, _L, _P = ctypes.c_double, ctypes.c_int, ctypes.c_longlong, ctypes.c_void_p
_SIGNATURES: dict[str, tuple[Any, Sequence[Any]]] = {
    "vd_prepare_lanes": (None, [_P, _P]),
    "vd_rates_lanes": (_I, [_D, *[_P] * 7]),
    "vd_begin_lanes": (_I, [_D, _P, _P, _P, _I, _P, _P, _L, _P, _P, _P, _P]),
    "vd_evaluate_lanes": (_I, [_P] * 8),
    "vd_follow_lanes": (_I, [_D, _I, _D, _P, _P, _P, _D, _I, _P, _P, _L, *[_P] * 5]),
    "vd_advance_lanes": (
        _I,
        [_I, _L, _L, _L, _D, _D, *[_P] * 4, _I, _P, _P, _L, _D, *[_P] * 5],
    ),
}
_ALIGNMENT = 64

CHOICES = (1, 4, 8)
"""Numbers of lanes that may be asked for."""


@dataclass
class Fate:
    """Why and where lanes stopped; the status of those that go on is Status.SOLVED."""

    status: NDArray[np.intc]
    where: NDArray[np.intc]
    residual: Vector

    @classmethod
    def unknown(cls, lanes: int) -> Fate:
        """Return that of lanes that have not begun."""
        return cls(np.zeros(lanes, np.intc), np.zeros(lanes, np.intc), np.zeros(lanes))

    def pointers(self) -> list[int]:
        """Return the addresses for C."""
        return [array.ctypes.data for array in (self.status, self.where, self.residual)]


class LaneEngine:
    """Machine code of one model for ``lanes`` cases at once.

    Arrays of numbers in lanes have the shape (n, lanes) and come from :meth:`room` or
    :meth:`spread`.
    """

    def __init__(self, equations: Equations, path: Path) -> None:
        """Load a library.

        Raises
        ------
        OSError, AttributeError, ValueError
            If the file is no library, or not one of a kernel.
        """
        library = ctypes.CDLL(str(path))
        for name, (result, arguments) in _SIGNATURES.items():
            function = getattr(library, name)
            function.restype, function.argtypes = result, arguments
        self._library = library
        self._sizes = (len(equations.states), len(equations.unknowns))
        self._n_parameters = len(equations.parameters)
        self._tables = TableRows(equations.tables)
        self._n_constants = int(_I.in_dll(library, "vd_constants").value)
        self.lanes = int(_I.in_dll(library, "vd_lanes").value)
        self.n_watched = int(_I.in_dll(library, "vd_watched").value)

    def room(self, count: int) -> Vector:
        """Return zeros in lanes, aligned as the registers of the processor ask."""
        size = max(1, count) * self.lanes
        raw = np.zeros(size + _ALIGNMENT // 8)
        first = -(raw.ctypes.data // 8) % (_ALIGNMENT // 8)
        return raw[first : first + size].reshape(max(1, count), self.lanes)

    def copied(self, values: Vector) -> Vector:
        """Return a copy of numbers in lanes."""
        room = self.room(len(values))
        room[:] = values
        return room

    def address(self, name: str) -> int:
        """Return the address of an exported function, such as "vd_follow_lanes"."""
        return int(ctypes.cast(getattr(self._library, name), _P).value or 0)

    def spread(self, rows: Vector) -> Vector:
        """Return cases (at most ``lanes``, n) in lanes; the last one fills those left over."""
        values = self.room(rows.shape[1])
        for lane in range(self.lanes):
            values[: rows.shape[1], lane] = rows[min(lane, len(rows) - 1)]
        return values

    def prepare(self, parameters: Vector) -> Vector:
        """Return what depends on the parameters alone, in lanes."""
        given = self._before_tables(self._n_parameters)
        given[: self._n_parameters] = parameters[: self._n_parameters]
        constants = self._before_tables(self._n_constants)
        self._library.vd_prepare_lanes(given.ctypes.data, constants.ctypes.data)
        return constants

    def _before_tables(self, count: int) -> Vector:
        """Return room for numbers in lanes, with the rows of the tables behind them."""
        room = self.room(count + len(self._tables.numbers))
        room[count : count + len(self._tables.numbers)] = self._tables.numbers[:, None]
        return room

    def rates(
        self, time: float, state: Vector, unknowns: Vector, constants: Vector
    ) -> tuple[Vector, Fate]:
        """Solve the unknowns in place and return the rates of the states, in lanes."""
        rates, fate = self.room(self._sizes[0]), Fate.unknown(self.lanes)
        arrays = [item.ctypes.data for item in (state, unknowns, constants, rates)]
        self._library.vd_rates_lanes(time, *arrays, *fate.pointers())
        return rates, fate

    def begin(self, *arguments: Any) -> bool:
        """Call vd_begin_lanes of batch.c; return whether any lane goes on."""
        return bool(self._library.vd_begin_lanes(*arguments))

    def advance(self, *arguments: Any) -> bool:
        """Call vd_advance_lanes of batch.c; return whether any lane goes on."""
        return bool(self._library.vd_advance_lanes(*arguments))


def compile_lanes(equations: Equations, key: str, lanes: int) -> tuple[LaneEngine, str]:
    """Return the engine of so many lanes, from the cache if it is there, and a remark.

    ``key`` is that of the model's kernel for one case.

    Raises
    ------
    CompilationError
        If there is no compiler, or it fails.
    """
    compiler = find_compiler()

    def build(folder: Path) -> Path:
        cut = cut_at_seam(equations)
        if cut is not None:
            return seam_library(cut, compiler, folder, lanes)
        source = lane_source(equations, derive_functions(equations), lanes)
        return build_library(compiler, source, folder)

    own = cache.key_of(key, f"{lanes} lanes")
    with without_collection():
        engine, entry = cache.load(own, build, lambda path: LaneEngine(equations, path))
    return engine, entry.remark
