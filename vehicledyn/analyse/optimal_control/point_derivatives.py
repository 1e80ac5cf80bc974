"""Values and first and second derivatives of a point function at many points at once."""

from __future__ import annotations

import logging
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.optimal_control.point_function import PointFunction
from vehicledyn.codegen.passes.kernel_functions import operations_in
from vehicledyn.codegen.toolchain.compiler import CompilationError
from vehicledyn.kernel.point_slopes import PointCode
from vehicledyn.symbolic import ops

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

_log = logging.getLogger(__name__)

_WORTH_COMPILING = 30_000
"""Operations of values times variables from which on derivatives are compiled.

Below, a search of a hundred iterations on a hundred points is over before the compiler is.
"""


class PointDerivatives:
    """Evaluates a point function, compiled where that pays and a compiler works.

    ``jacobian_entries`` are (outputs, variables) of the derivatives that may differ from zero,
    ``hessian_entries`` (variables, variables) those of second ones, the first not above the second.

    Parameters
    ----------
    function
        The function.
    """

    def __init__(self, function: PointFunction) -> None:
        import casadi

        f = self._function = function
        weights = casadi.SX.sym("l", f.outputs.numel())
        total = casadi.dot(weights, f.outputs)
        gradient = casadi.cse(casadi.densify(ops.jacobian(total, f.variables).T))
        first = casadi.jacobian_sparsity(f.outputs, f.variables)
        second = casadi.triu(casadi.jacobian_sparsity(gradient, f.variables))
        self.jacobian_entries = _entries(first)
        self.hessian_entries = _entries(second)
        self._backend = self._compiled(weights, gradient) or _Interpreted(
            f, weights, gradient, first, second
        )

    @property
    def n_outputs(self) -> int:
        """Number of outputs."""
        return int(self._function.outputs.numel())

    @property
    def is_compiled(self) -> bool:
        """Whether machine code evaluates."""
        return isinstance(self._backend, _Compiled)

    def values(self, points: Floats, constants: Floats) -> Floats:
        """Return the outputs at points (n, n_variables), (n, n_constants); shape (n, n_outputs)."""
        return self._backend.values(points, constants)

    def jacobian(self, points: Floats, constants: Floats) -> Floats:
        """Return the derivatives of ``jacobian_entries`` at points, shape (n, n_entries)."""
        return self._backend.jacobian(points, constants)

    def hessian(self, points: Floats, constants: Floats, weights: Floats) -> Floats:
        """Return second derivatives of outputs times weights (n, n_outputs), (n, n_entries)."""
        return self._backend.hessian(points, constants, weights)

    def _compiled(self, weights: Any, gradient: Any) -> _Compiled | None:
        import casadi

        f = self._function
        given = [f.variables, f.constants]
        work = operations_in(casadi.Function("f", given, [f.outputs])) * f.variables.numel()
        if work < _WORTH_COMPILING:
            return None
        try:
            return _Compiled(f, weights, gradient, self.jacobian_entries, self.hessian_entries)
        except CompilationError as error:
            _log.warning(
                "%s; the derivatives of the motion are interpreted, ten times slower", error
            )
            return None


class _Compiled:
    """Machine code: directional derivatives, one direction in each lane of the processor."""

    def __init__(
        self,
        function: PointFunction,
        weights: Any,
        gradient: Any,
        first: tuple[Indices, Indices],
        second: tuple[Indices, Indices],
    ) -> None:
        import casadi

        f, nothing = function, casadi.SX(0, 1)
        self._nothing = np.zeros(0)
        moving, bending = (np.unique(np.concatenate(pair)) for pair in (first[1:], second))
        point = casadi.vertcat(f.variables, f.constants)
        self._values = PointCode(f.outputs, point, nothing, f.tables)
        self._slopes = _Directional(f.outputs, f, moving, nothing)
        self._bends = _Directional(gradient[bending.tolist()], f, bending, weights)
        place = np.zeros(f.variables.numel(), dtype=np.int64)
        place[moving] = np.arange(moving.size)
        self._first = first[0], place[first[1]]
        place[bending] = np.arange(bending.size)
        self._second = place[second[0]], place[second[1]]

    def values(self, points: Floats, constants: Floats) -> Floats:
        return self._values.values(np.hstack([points, constants]), self._nothing)

    def jacobian(self, points: Floats, constants: Floats) -> Floats:
        return self._slopes.at(points, constants, points[:, :0])[:, self._first[0], self._first[1]]

    def hessian(self, points: Floats, constants: Floats, weights: Floats) -> Floats:
        return self._bends.at(points, constants, weights)[:, self._second[0], self._second[1]]


class _Directional:
    """Machine code of values and their derivatives by the variables that count."""

    def __init__(self, values: Any, function: PointFunction, moving: Indices, more: Any) -> None:
        import casadi

        f = function
        still = np.setdiff1d(np.arange(f.variables.numel()), moving)
        self._order = np.concatenate([moving, still])
        ordered = f.variables[self._order.tolist()]
        point = casadi.vertcat(ordered, f.constants, more)
        nothing = casadi.SX(0, 1)
        self._code = PointCode(values, point, nothing, f.tables, first=moving.size)

    def at(self, points: Floats, constants: Floats, more: Floats) -> Floats:
        """Return the derivatives at points, shape (n, n_values, n_moving)."""
        given = np.hstack([points[:, self._order], constants, more])
        return self._code.slopes(given, np.zeros(0))[1]


class _Interpreted:
    """Functions that CasADi evaluates."""

    def __init__(
        self, function: PointFunction, weights: Any, gradient: Any, first: Any, second: Any
    ) -> None:
        import casadi

        f = function
        given = [f.variables, f.constants]
        slopes = ops.jacobian(f.outputs, f.variables)
        bends = ops.jacobian(gradient, f.variables)
        columns = [
            casadi.densify(_those(item, of)) for item, of in ((slopes, first), (bends, second))
        ]
        self._values = casadi.Function("values", given, [f.outputs])
        self._slopes = casadi.Function("slopes", given, [casadi.cse(columns[0])])
        self._bends = casadi.Function("bends", [*given, weights], [casadi.cse(columns[1])])

    def values(self, points: Floats, constants: Floats) -> Floats:
        return _mapped(self._values, points, constants)

    def jacobian(self, points: Floats, constants: Floats) -> Floats:
        return _mapped(self._slopes, points, constants)

    def hessian(self, points: Floats, constants: Floats, weights: Floats) -> Floats:
        return _mapped(self._bends, points, constants, weights)


def _entries(pattern: Any) -> tuple[Indices, Indices]:
    """Return rows and columns of a pattern, column by column."""
    return np.array(pattern.row(), dtype=np.int64), np.array(pattern.get_col(), dtype=np.int64)


def _those(matrix: Any, pattern: Any) -> Any:
    """Return the elements of a matrix at a pattern as a column."""
    import casadi

    return casadi.project(matrix, pattern).nz[:]


def _mapped(function: Any, *given: Floats) -> Floats:
    """Return what a function gives for each row of its arguments, row by row."""
    if not function.numel_out(0):
        return np.zeros((len(given[0]), 0))
    mapped = function.map(len(given[0]))
    return np.array(mapped(*[item.T for item in given])).T
