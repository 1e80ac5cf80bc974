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

from vehicledyn.base.errors import MissingPartError, NumericalError
from vehicledyn.codegen.ir.table_rows import TableRows
from vehicledyn.codegen.passes.branch_functions import BranchFunctions
from vehicledyn.codegen.passes.kernel_functions import derive_functions
from vehicledyn.codegen.passes.linear_program import LinearProgram
from vehicledyn.codegen.passes.stage_program import (
    PointProgram,
    StageProgram,
    point_program,
    stage_program,
    suitable_residuals,
)
from vehicledyn.codegen.printers.tangent_source import tangent_lanes, tangent_source
from vehicledyn.codegen.toolchain import cache
from vehicledyn.codegen.toolchain.compiler import CompilationError, build_library, find_compiler
from vehicledyn.codegen.toolchain.fingerprint import (
    fingerprint,
    function_text,
    generator_fingerprint,
)
from vehicledyn.kernel.engine import Status, Vector
from vehicledyn.kernel.plans import Passes, aligned, passes
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Equations
from vehicledyn.symbolic.shared import inlined

Array = NDArray[np.float64]

_D, _I, _L, _P = ctypes.c_double, ctypes.c_int, ctypes.c_longlong, ctypes.c_void_p
_SIGNATURES: dict[str, tuple[Any, Sequence[Any]]] = {
    "vd_prepare": (None, [_P, _P]),
    "vd_solve_point": (_I, [_D, _P, _P, _P]),
    "vd_plan": (_L, [_P] * 5),
    "vd_weigh_directions": (None, [_P] * 3),
    "vd_share": (None, [_L, _P, _P]),
    "vd_tangent_steps": (_I, [_P, _L, _L, *[_P] * 11]),
    "vd_tangent_points": (_I, [_L, *[_P] * 10]),
}
_BRANCHES: dict[str, tuple[Any, Sequence[Any]]] = {"vd_branch_values": (None, [_L, *[_P] * 5])}
_BACK: dict[str, tuple[Any, Sequence[Any]]] = {
    "vd_record": (_I, [_P, _L, _L, *[_P] * 6]),
    "vd_steps_back": (_I, [_P, _L, _L, *[_P] * 8]),
    "vd_values_back": (_I, [_L, *[_P] * 8]),
}


@dataclass(frozen=True)
class StepRow:
    """Fixed steps: the method's number, the start [s], the interval [s] and the steps in it."""

    method: int
    start: float
    interval: float
    per_interval: int


class MotionPoint(NamedTuple):
    """A time [s] with states, unknowns and constants there."""

    time: float
    state: Vector
    unknowns: Vector
    constants: Vector


class StepSpan(NamedTuple):
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
        residuals = suitable_residuals(equations)
        functions = derive_functions(equations, residuals)
        self._prepare = functions.prepare
        accelerated = () if residuals is None else residuals.rows
        self.stage: StageProgram = stage_program(equations, functions, accelerated)
        self.observed: PointProgram = point_program(functions, self._observed(functions))
        self.n_values: int = self.observed.function.numel_out(0)
        self.lanes = tangent_lanes()
        self._tables = TableRows(equations.tables)
        self._functions = functions
        self._known: tuple[Vector, Any] | None = None
        self._passes: dict[int, tuple[Array, Passes]] = {}

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
                self.equations,
                self._functions,
                self.stage,
                self.observed,
                self.branches,
                back=self.back,
            )
            return build_library(compiler, text, folder)

        def opened(path: Path) -> ctypes.CDLL:
            library = ctypes.CDLL(str(path))
            offered = _SIGNATURES | (_BACK if self.back else {})
            offered |= _BRANCHES if self.branches.count else {}
            for name, (result, arguments) in offered.items():
                function = getattr(library, name)
                function.restype, function.argtypes = result, arguments
            return library

        balance = self._functions.balance
        parts = (
            "tangents",
            repr((self.channels, self.back)),
            "" if balance is None else function_text(balance, self.equations.tables),
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

    def shared_parameters(self, parameters: Vector) -> Array:
        """Return parameters and rows of tables as all lanes have them."""
        given = self._tables.after(np.ascontiguousarray(parameters, dtype=float))
        found = aligned((len(given) + 1, self.lanes))
        self.call("vd_share", len(given), given, found)
        return found

    def constant_slopes(self, parameters: Vector) -> Any:
        """Return ∂c/∂p at some parameters, a sparse matrix (n_constants, n_parameters)."""
        from scipy.sparse import csc_matrix

        if self._known is not None and np.array_equal(self._known[0], parameters):
            return self._known[1]
        slope = self._constant_slopes(parameters)
        pattern = slope.sparsity()
        values = np.array(slope.nonzeros())
        found = csc_matrix((values, pattern.row(), pattern.colind()), shape=slope.shape)
        self._known = np.array(parameters), found
        return found

    @cached_property
    def _constant_slopes(self) -> Any:
        import casadi

        p = casadi.SX.sym("p", self._prepare.numel_in(0))
        slopes = ops.jacobian(inlined(self._prepare(p)), p)
        return casadi.Function("constant_slopes", [p], [slopes])

    @cached_property
    def branches(self) -> BranchFunctions:
        """The functions that choose between branches of the equations."""
        return BranchFunctions.of(self.equations)

    @cached_property
    def seen(self) -> LinearProgram:
        """The program of unknowns and what is observed."""
        stage = self.stage
        return stage.program.with_values(stage.n_unknowns, self.observed.program, stage.n_weights)

    @cached_property
    def to_rates(self) -> Passes:
        """Passes by time, states and unknowns to unknowns and rates, which are compiled."""
        count = _I.in_dll(self._library, "vd_pattern").value
        pattern = np.array((_I * (1 + 2 * count)).in_dll(self._library, "vd_pattern")[1:])
        entries = np.column_stack([pattern.reshape(count, 2), np.arange(count)])
        return Passes([], [], entries.astype(np.int64), count)

    @cached_property
    def to_seen(self) -> Passes:
        """Passes by time, states and unknowns to unknowns and what is seen."""
        one = np.eye(1 + len(self.equations.states) + len(self.equations.unknowns))
        return passes(self.call, self.seen, one)

    def passes_by(self, program: LinearProgram, constants: Array) -> Passes:
        """Return passes of a program for directions of the constants (n_constants, n_directions).

        The last ones are kept: a motion and its start ask for the same.
        """
        known = self._passes.get(id(program))
        if known is not None and np.array_equal(known[0], constants):
            return known[1]
        n_before = 1 + len(self.equations.states) + len(self.equations.unknowns)
        seeds = np.vstack([np.zeros((n_before, constants.shape[1])), constants])
        found = passes(self.call, program, seeds)
        self._passes[id(program)] = constants.copy(), found
        return found

    def numbers(self) -> Numbers:
        """Return room for what is computed at points."""
        return Numbers(self)

    def call(self, name: str, *arguments: Any) -> int:
        """Call a function of the library; arrays are given by their place."""
        given = [_address(item) for item in arguments]
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


class Numbers:
    """Constants and weights at several points, as C reads them."""

    def __init__(self, code: TangentCode) -> None:
        """Make room."""
        stage, observed = code.stage, code.observed
        n_x, n_z = len(code.equations.states), len(code.equations.unknowns)
        n_accelerated, n_inverse = len(stage.accelerated), stage.function.numel_out(1)
        before = stage.n_weights
        n_observed = observed.function.numel_out(1)
        fixed = stage.program.fixed, observed.program.fixed
        self._code = code
        self._known: Vector | None = None
        self._weights = aligned((before + n_observed + len(fixed[1]) + 1, code.lanes))
        for own, first in zip(fixed, (before - len(fixed[0]), before + n_observed), strict=True):
            self._weights[first : first + len(own)] = own[:, None]
        sizes = n_x, n_z, n_accelerated, n_inverse
        self._points = aligned((1 + sum(sizes) + len(sizes), code.lanes))
        self._lanes = aligned((1, code.lanes))
        self._struct = (_P * 4)()

    def of(self, constants: Vector) -> Any:
        """Return the address of all for some constants."""
        if self._known is not constants:
            self._known = constants
            self._lanes = aligned((len(constants), self._code.lanes))
            self._code.call("vd_share", len(constants), constants, self._lanes)
            rooms = (constants, self._lanes, self._weights, self._points)
            self._struct[:] = [item.ctypes.data for item in rooms]
        return ctypes.addressof(self._struct)


def steps_of(grid: StepRow, span: tuple[float, float] = (0.0, 1.0)) -> ctypes.Structure:
    """Return what C knows of steps, or of a part of one."""
    return _Steps(grid.method, grid.per_interval, grid.start, grid.interval, *span)


class _Steps(ctypes.Structure):
    _fields_ = [
        ("method", _I),
        ("per", _L),
        *[(name, _D) for name in ("start", "interval", "from_", "to")],
    ]


def _address(item: Any) -> Any:
    """Return an argument as C takes it: arrays and structures by their place."""
    if isinstance(item, np.ndarray):
        return item.ctypes.data
    return ctypes.addressof(item) if isinstance(item, ctypes.Structure) else item
