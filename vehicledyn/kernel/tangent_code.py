"""Compiled code for the tangents of a motion, called through ctypes."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError, MissingPartError, NumericalError
from vehicledyn.codegen.ir.table_rows import TableRows
from vehicledyn.codegen.passes.kernel_functions import derive_functions
from vehicledyn.codegen.passes.linear_program import (
    PointProgram,
    Program,
    StageProgram,
    point_program,
    stage_program,
)
from vehicledyn.codegen.printers.tangent_source import tangent_lanes, tangent_source
from vehicledyn.codegen.toolchain import cache
from vehicledyn.codegen.toolchain.compiler import CompilationError, build_library, find_compiler
from vehicledyn.codegen.toolchain.fingerprint import fingerprint, generator_fingerprint
from vehicledyn.kernel.engine import Status, Vector
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Equations
from vehicledyn.symbolic.shared import inlined

_D, _I, _L, _P = ctypes.c_double, ctypes.c_int, ctypes.c_longlong, ctypes.c_void_p
_SIGNATURES: dict[str, tuple[Any, Sequence[Any]]] = {
    "vd_prepare": (None, [_P, _P]),
    "vd_solve_point": (_I, [_D, _P, _P, _P]),
    "vd_linearise": (_I, [_D, _P, _P, _P, _P, _P]),
    "vd_observe": (None, [_D, _P, _P, _P, _P, _P]),
    "vd_tangent_steps": (_I, [_I, _L, _L, _D, _D, _L, _D, _D, *[_P] * 6]),
    "vd_tangent_point": (_I, [_D, *[_P] * 9]),
    "vd_tangent_values": (None, [_D, *[_P] * 7, _L, _P, _P]),
}
_BACK: dict[str, tuple[Any, Sequence[Any]]] = {
    "vd_record": (_I, [_L, _L, _L, _D, _D, *[_P] * 6]),
    "vd_steps_back": (_I, [_L, _L, _L, _D, _D, *[_P] * 4, _L, *[_P] * 4]),
    "vd_values_back": (_I, [_D, *[_P] * 8, _L, *[_P] * 6]),
}


class _Rows(ctypes.Structure):
    _fields_ = [
        ("n_touched", _L),
        ("n_rows", _L),
        ("n_columns", _L),
        *[(name, _P) for name in ("out", "starts", "columns", "which", "targets", "unknowns")],
    ]


class _Directions(ctypes.Structure):
    _fields_ = [("n", _L), *[(name, _P) for name in ("columns", "x", "from_", "to", "room")]]


@dataclass(frozen=True)
class Grid:
    """Fixed steps: the method's number, the start [s], the interval [s] and the steps in it."""

    method: int
    start: float
    interval: float
    per_interval: int


class Moment(NamedTuple):
    """A time [s] with states, unknowns and constants there."""

    time: float
    state: Vector
    unknowns: Vector
    constants: Vector


class Way(NamedTuple):
    """Steps to take: the number of the first, how many, and of one the part to take."""

    first: int
    n_steps: int
    span: tuple[float, float] = (0.0, 1.0)


class TangentCode:
    """Rates, unknowns and observed functions of a model with their derivatives.

    Observed are the chosen channels, then the functions of the events, then their new values.
    """

    def __init__(
        self, equations: Equations, channels: Sequence[int], *, back: bool = False
    ) -> None:
        """Derive; with ``back`` for adjoints as well.

        It is compiled, or found in the cache, when it is first called, which raises a
        MissingPartError where no C compiler works: what is wrong with an input comes first.
        """
        self.equations, self.channels, self.back = equations, tuple(channels), back
        functions = derive_functions(equations)
        self._prepare = functions.prepare
        self.stage: StageProgram = stage_program(equations, functions)
        self.observed: PointProgram = point_program(functions, self._observed(functions))
        self.n_values: int = self.observed.function.numel_out(0)
        self.lanes = tangent_lanes()
        self._tables = TableRows(equations.tables)
        self._functions = functions
        self._n_inverse = sum((b.stop - b.start) ** 2 for b in equations.blocks)

    def _observed(self, functions: Any) -> list[Any]:
        rows = list(self.channels)
        return [lambda *p: functions.outputs(*p)[rows], functions.events, functions.resets]

    @cached_property
    def _library(self) -> ctypes.CDLL:
        try:
            compiler = find_compiler()
        except CompilationError as error:
            raise MissingPartError(
                f"sensitivities of motions need compiled code, but {error}; install gcc or clang"
            ) from None

        def build(folder: Path) -> Path:
            text = tangent_source(
                self.equations, self._functions, self.stage, self.observed, back=self.back
            )
            return build_library(compiler, text, folder)

        def opened(path: Path) -> ctypes.CDLL:
            library = ctypes.CDLL(str(path))
            for name, (result, arguments) in (_SIGNATURES | (_BACK if self.back else {})).items():
                function = getattr(library, name)
                function.restype, function.argtypes = result, arguments
            return library

        parts = (
            "tangents",
            repr((self.channels, self.back)),
            generator_fingerprint(),
            compiler.identity,
        )
        return cache.load(cache.key_of(fingerprint(self.equations), *parts), build, opened)[0]

    def _n_copies(self) -> int:
        return int(_I.in_dll(self._library, "vd_copies").value)

    @property
    def n_constants(self) -> int:
        """Number of constants."""
        return int(self._prepare.numel_out(0))

    def constants(self, parameters: Vector) -> Vector:
        """Return what depends on the parameters alone."""
        given = self._tables.after(np.ascontiguousarray(parameters, dtype=float))
        n = self._prepare.numel_out(0)
        found = np.concatenate([self._tables.after(np.zeros(n)), np.zeros(self._n_copies())])
        self._library.vd_prepare(given.ctypes.data, found.ctypes.data)
        return found

    def constant_slopes(self, parameters: Vector) -> Any:
        """Return ∂c/∂p at some parameters, a sparse matrix (n_constants, n_parameters)."""
        from scipy.sparse import csc_matrix

        slope = self._constant_slopes(parameters)
        pattern = slope.sparsity()
        return csc_matrix(
            (np.array(slope.nonzeros()), pattern.row(), pattern.colind()), shape=slope.shape
        )

    @cached_property
    def _constant_slopes(self) -> Any:
        import casadi

        p = casadi.SX.sym("p", self._prepare.numel_in(0))
        slopes = ops.jacobian(inlined(self._prepare(p)), p)
        return casadi.Function("constant_slopes", [p], [slopes])

    def weights(self) -> Vector:
        """Return room for the weights of the stage, the fixed ones entered."""
        return self._room(self.stage.function, self.stage.program, self._n_inverse)

    def observed_weights(self) -> Vector:
        """Return room for the weights of what is observed, the fixed ones entered."""
        return self._room(self.observed.function, self.observed.program, 0)

    @staticmethod
    def _room(function: Any, program: Program, n_inverse: int) -> Vector:
        own = function.numel_out(1) + n_inverse
        return np.concatenate([np.zeros(own), program.fixed, np.zeros(1)])

    def call(self, name: str, *arguments: Any) -> int:
        """Call a function of the library; arrays are given by their place."""
        given = [item.ctypes.data if isinstance(item, np.ndarray) else item for item in arguments]
        return int(getattr(self._library, name)(*given) or 0)

    def solved(self, time: float, state: Vector, guess: Vector, constants: Vector) -> Vector:
        """Return the unknowns at a point.

        Raises
        ------
        NumericalError
            If they are not found.
        """
        unknowns = np.array(guess)
        self.check(self.call("vd_solve_point", time, state, unknowns, constants), time)
        return unknowns

    def check(self, status: int, time: float) -> None:
        """Raise NumericalError for a status other than solved."""
        if status != Status.SOLVED:
            reason = Status(status).name.lower().replace("_", " ")
            raise NumericalError(
                f"the constraints of '{self.equations.name}' have no tangents near t = "
                f"{time:.9g} s: {reason}"
            )


class Bundle:
    """Directions carried side by side: tangents of states, by lanes.

    Parameters
    ----------
    code
        The compiled code.
    constants
        Tangents of the constants, shape (n_constants, n_directions).
    """

    def __init__(self, code: TangentCode, constants: NDArray[np.float64]) -> None:
        n_x, n_z = len(code.equations.states), len(code.equations.unknowns)
        self._code, lanes = code, code.lanes
        self.n_directions = constants.shape[1]
        groups = self._groups = max(1, -(-self.n_directions // lanes))
        moving = np.any(constants != 0.0, axis=1)
        self._stage = code.stage.program
        self._observed = code.observed.program
        self._spread = np.zeros((constants.shape[0], groups, lanes))
        self._spread.reshape(len(constants), -1)[:, : self.n_directions] = constants
        self._x = _aligned((groups, n_x, lanes))
        self._z = _aligned((groups, n_z, lanes))
        self._from, self._to = _aligned((groups, lanes)), _aligned((groups, lanes))
        room = _aligned((3, groups, max(1, n_x), lanes))
        self._rate = _aligned((groups, n_x, lanes))
        self._values = _aligned((groups, code.n_values, lanes))
        self._columns = [
            self._filled(program.n_columns, len(program.out), first)
            for program, first in ((self._stage, 1 + n_x), (self._observed, 1 + n_x + n_z))
        ]
        shared = (self._x, self._from, self._to, room)
        self._rows = _rows(self._stage, code.stage.unknowns, 1 + n_x, moving)
        self._observed_rows = _rows(self._observed, code.stage.unknowns, 1 + n_x + n_z, moving)
        self._directions = [
            _Directions(groups, *[item.ctypes.data for item in (columns, *shared)])
            for columns in self._columns
        ]
        self._keep = shared
        self._weights, self._observed_weights = code.weights(), code.observed_weights()

    def _filled(self, n_columns: int, n_rows: int, first: int) -> NDArray[np.float64]:
        columns = _aligned((self._groups, n_columns + n_rows, self._code.lanes))
        stop = first + len(self._spread)
        columns[:, first:stop] = self._spread.transpose(1, 0, 2)
        return columns

    @property
    def state(self) -> NDArray[np.float64]:
        """Tangents of the states, shape (n_states, n_directions)."""
        return self._plain(self._x)

    @state.setter
    def state(self, values: NDArray[np.float64]) -> None:
        self._enter(self._x, values)

    def steps(
        self, grid: Grid, way: Way, moment: Moment, times: tuple[Vector, Vector] | None = None
    ) -> None:
        """Take steps from a moment, moving its state and unknowns and the tangents in place.

        ``times`` are the tangents of the begin and end of a part of a step [s], zero if None.
        """
        self._at(times)
        status = self._code.call(
            "vd_tangent_steps",
            grid.method,
            way.first,
            way.n_steps,
            *way.span,
            grid.per_interval,
            grid.start,
            grid.interval,
            moment.constants,
            moment.state,
            moment.unknowns,
            self._weights,
            ctypes.addressof(self._rows[0]),
            ctypes.addressof(self._directions[0]),
        )
        self._code.check(status, moment.time)

    def point(
        self, moment: Moment, at: Vector | None = None
    ) -> tuple[Vector, NDArray[np.float64], NDArray[np.float64]]:
        """Return the rates, tangents of the unknowns and of the rates, by those of the states.

        ``at`` are the tangents of the time [s].
        """
        self._at(None if at is None else (at, at))
        rate = np.zeros(max(1, len(moment.state)))
        status = self._code.call(
            "vd_tangent_point",
            *moment,
            self._weights,
            ctypes.addressof(self._rows[0]),
            ctypes.addressof(self._directions[0]),
            rate,
            self._z,
            self._rate,
        )
        self._code.check(status, moment.time)
        return rate[: len(moment.state)], self._plain(self._z), self._plain(self._rate)

    def values(
        self, moment: Moment, at: Vector | None = None
    ) -> tuple[Vector, NDArray[np.float64]]:
        """Return what is observed and its tangents, after :meth:`point` at the same moment."""
        self._at(None if at is None else (at, at))
        values = np.zeros(max(1, self._code.n_values))
        self._code.call(
            "vd_tangent_values",
            *moment,
            self._observed_weights,
            ctypes.addressof(self._observed_rows[0]),
            ctypes.addressof(self._directions[1]),
            self._z,
            self._code.n_values,
            values,
            self._values,
        )
        return values[: self._code.n_values], self._plain(self._values)

    def _at(self, times: tuple[Vector, Vector] | None) -> None:
        zero = np.zeros(self.n_directions)
        for room, values in zip((self._from, self._to), times or (zero, zero), strict=True):
            room.reshape(-1)[: self.n_directions] = values

    def _plain(self, lanes: NDArray[np.float64]) -> NDArray[np.float64]:
        swapped = lanes.transpose(1, 0, 2)
        return swapped.reshape(lanes.shape[1], lanes.shape[0] * lanes.shape[2])[
            :, : self.n_directions
        ].copy()

    def _enter(self, lanes: NDArray[np.float64], values: NDArray[np.float64]) -> None:
        if values.shape != (lanes.shape[1], self.n_directions):
            raise InputError(f"tangents of shape {values.shape} do not fit")
        spread = np.zeros((lanes.shape[1], lanes.shape[0] * lanes.shape[2]))
        spread[:, : self.n_directions] = values
        lanes[:] = spread.reshape(lanes.shape[1], lanes.shape[0], lanes.shape[2]).transpose(1, 0, 2)


def _rows(
    program: Program, unknowns: Any, first_constant: int, moving: NDArray[np.bool_]
) -> tuple[_Rows, Any]:
    """Return what C knows of a program whose constants move or rest, and the arrays pointed at."""
    touched = program.touched(first_constant, moving)
    arrays = [
        np.ascontiguousarray(item, dtype=np.int32) for item in (*touched, program.targets, unknowns)
    ]
    sizes = (len(touched[0]), len(program.out), program.n_columns)
    return _Rows(*sizes, *[item.ctypes.data for item in arrays]), arrays


def _aligned(shape: tuple[int, ...]) -> NDArray[np.float64]:
    """Return zeros that begin at a multiple of 64 bytes."""
    size = int(np.prod(shape))
    raw = np.zeros(size + 8)
    first = -(raw.ctypes.data // 8) % 8
    return raw[first : first + size].reshape(shape)
