"""The engine that calls compiled C through ctypes."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.codegen.ir.table_rows import TableRows
from vehicledyn.codegen.passes.kernel_functions import COUNTED
from vehicledyn.kernel.engine import Addresses, Ledger, March, SampleRows, Span, Status, Vector
from vehicledyn.symbolic.equations import Equations

_D, _I, _L, _P = ctypes.c_double, ctypes.c_int, ctypes.c_longlong, ctypes.c_void_p
_SIGNATURES: dict[str, tuple[Any, Sequence[Any]]] = {
    "vd_prepare": (None, [_P, _P]),
    "vd_rates": (None, [_D, _P, _P, _P, _P]),
    "vd_outputs": (None, [_D, _P, _P, _P, _P]),
    "vd_block": (None, [_I, _D, _P, _P, _P, _P, _P]),
    "vd_survey": (None, [_L, *[_P] * 6]),
    "vd_solve": (_I, [_D, _P, _P, _P, _P, _P]),
    "vd_advance": (_I, [_I, _L, _L, _L, _D, _D, *[_P] * 10]),
    "vd_advance_part": (_I, [_I, _L, _D, _D, _L, _D, _D, *[_P] * 5]),
    "vd_events": (None, [_D, _P, _P, _P, _P]),
    "vd_resets": (None, [_D, _P, _P, _P, _P]),
}


class CompiledEngine:
    """Machine code of one model."""

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
        self._sizes = [block.stop - block.start for block in equations.blocks]
        self._tables = TableRows(equations.tables)
        self._n_rates = len(equations.states)
        self._n_outputs = len(equations.channels)
        self._n_events = len(equations.events)
        self._n_resets = int(_I.in_dll(library, "vd_new_values").value)
        self._n_constants = int(_I.in_dll(library, "vd_constants").value)
        self._n_copies = int(_I.in_dll(library, "vd_copies").value)
        counts = (_I * len(COUNTED)).in_dll(library, "vd_operations")
        self.operations = dict(zip(COUNTED, counts, strict=True))

    def address(self, name: str) -> int:
        """Return the address of an exported function, such as "vd_rates", for other libraries."""
        return int(ctypes.cast(getattr(self._library, name), _P).value or 0)

    def prepare(self, parameters: Vector) -> Vector:
        """Return what depends on the parameters alone."""
        constants = self._tables.after(np.zeros(self._n_constants))
        constants = np.concatenate([constants, np.zeros(self._n_copies)])
        given = self._tables.after(parameters)
        self._library.vd_prepare(given.ctypes.data, constants.ctypes.data)
        return constants

    def rates(self, time: float, state: Vector, unknowns: Vector, constants: Vector) -> Vector:
        """Return the rates of the states."""
        rates = np.empty(self._n_rates)
        pointers = [item.ctypes.data for item in (state, unknowns, constants, rates)]
        self._library.vd_rates(time, *pointers)
        return rates

    def outputs(self, time: float, state: Vector, unknowns: Vector, constants: Vector) -> Vector:
        """Return the named outputs."""
        outputs = np.empty(self._n_outputs)
        pointers = [item.ctypes.data for item in (state, unknowns, constants, outputs)]
        self._library.vd_outputs(time, *pointers)
        return outputs

    def block(
        self, index: int, time: float, state: Vector, unknowns: Vector, constants: Vector
    ) -> tuple[Vector, Vector]:
        """Return residual and Jacobian of a block."""
        size = self._sizes[index]
        residual, jacobian = np.empty(size), np.empty((size, size), order="F")
        arrays = (state, unknowns, constants, residual, jacobian)
        self._library.vd_block(index, time, *[item.ctypes.data for item in arrays])
        return residual, jacobian

    def survey(
        self, times: Vector, states: Vector, unknowns: Vector, constants: Vector
    ) -> tuple[Vector, Vector]:
        """Return largest residual and determinant of each block at some points."""
        residuals, determinants = np.empty((2, len(times), len(self._sizes)))
        arrays = (times, states, unknowns, constants, residuals, determinants)
        self._library.vd_survey(len(times), *[item.ctypes.data for item in arrays])
        return residuals, determinants

    def solve(
        self, time: float, state: Vector, unknowns: Vector, constants: Vector, ledger: Ledger
    ) -> Status:
        """Solve the blocks in order, changing the unknowns in place."""
        pointers = [item.ctypes.data for item in (state, unknowns, constants)]
        pointers += [ledger.counts.ctypes.data, ledger.figures.ctypes.data]
        return Status(self._library.vd_solve(time, *pointers))

    def advance(self, march: March, n_steps: int, constants: Vector, rows: SampleRows) -> Status:
        """Take steps and write a row for each whole interval."""
        moving = (march.state, march.unknowns, march.memory, march.sides)
        ledger = (march.ledger.counts, march.ledger.figures)
        arrays = (constants, *moving, rows.states, rows.unknowns, rows.outputs, *ledger)
        march.addresses = Addresses.of(arrays, march.addresses)
        return Status(
            self._library.vd_advance(
                int(march.method),
                march.step,
                n_steps,
                march.per_interval,
                march.start,
                march.interval,
                *march.addresses.numbers,
            )
        )

    def advance_part(self, march: March, part: Span, constants: Vector) -> Status:
        """Take a part of one step, moving state and unknowns but neither step nor sides."""
        ledger = (march.ledger.counts, march.ledger.figures)
        arrays = (constants, march.state, march.unknowns, *ledger)
        march.addresses = Addresses.of(arrays, march.addresses)
        return Status(
            self._library.vd_advance_part(
                int(march.method),
                march.step,
                *part,
                march.per_interval,
                march.start,
                march.interval,
                *march.addresses.numbers,
            )
        )

    def events(self, time: float, state: Vector, unknowns: Vector, constants: Vector) -> Vector:
        """Return the functions of the events."""
        values = np.empty(self._n_events)
        pointers = [item.ctypes.data for item in (state, unknowns, constants, values)]
        self._library.vd_events(time, *pointers)
        return values

    def resets(self, time: float, state: Vector, unknowns: Vector, constants: Vector) -> Vector:
        """Return the new values that events give to states."""
        values = np.empty(self._n_resets)
        pointers = [item.ctypes.data for item in (state, unknowns, constants, values)]
        self._library.vd_resets(time, *pointers)
        return values
