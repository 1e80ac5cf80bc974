"""Exact derivatives of rates, residuals and outputs, also through the algebraic unknowns.

Columns come from one forward derivative, evaluated for each unit direction: deriving it costs
as much as three times the equations, whatever the number of states.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.codegen.passes.kernel_functions import operations_in
from vehicledyn.codegen.toolchain.compiler import CompilationError
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.interpreted import BufferedFunction
from vehicledyn.kernel.point_slopes import PointCode
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Equations

_WORTH_COMPILING = 1_500_000
"""Operations of all columns of a Jacobian from which on it is compiled where many are wanted."""

_WORTH_WAITING = 6_000
"""Columns that are interpreted before: as long as the compiler takes, whatever the model's size."""


@dataclass(frozen=True)
class TotalDerivatives:
    """Derivatives along the motions that keep the loops closed.

    ``rates`` dẋ/dx (n_states, n_states), ``unknowns`` dz/dx (n_unknowns, n_states) and
    ``outputs`` dy/dx (n_channels, n_states); those by chosen parameters, dẋ/dp (n_states,
    n_chosen), dz/dp and dy/dp likewise.
    """

    rates: Vector
    unknowns: Vector
    outputs: Vector
    rates_by_parameter: Vector
    unknowns_by_parameter: Vector
    outputs_by_parameter: Vector


class Slopes(Protocol):
    """What evaluates derivatives along the motions that keep the loops closed."""

    def total(
        self, time: float, state: Vector, unknowns: Vector, parameters: Vector
    ) -> TotalDerivatives:
        """Return the derivatives at a point."""


class Derivatives:
    """Evaluates the derivatives of some equations at any point, for any parameters."""

    def __init__(
        self,
        equations: Equations,
        parameters: Sequence[str] = (),
        *,
        outputs: bool = True,
        often: bool = False,
    ) -> None:
        """Prepare derivatives, also by the parameters of these names; they are made when needed.

        Without ``outputs`` they are those of rates and residuals only, which takes half the time.
        Code of a large model is compiled at once where they are wanted ``often``, else after as
        many evaluations as the compiler costs.
        """
        self._equations = equations
        self._with_outputs = outputs and equations.output.numel() > 0
        names = [parameter.name for parameter in equations.parameters]
        self._chosen = [names.index(name) for name in parameters]
        self._left = 0 if often else _WORTH_WAITING

    @cached_property
    def _results(self) -> Any:
        """The rates, residuals and outputs to derive."""
        import casadi

        e = self._equations
        output = e.output if self._with_outputs else casadi.SX(0, 1)
        if not (e.states or e.unknowns or output.numel()):
            return casadi.SX(0, 1)
        return casadi.cse(casadi.densify(casadi.vertcat(e.rate, e.residual, output)))

    @cached_property
    def _machine(self) -> PointCode | None:
        """Compiled derivatives; None for small models and without a compiler."""
        return _compiled(self._equations, self._results, self._chosen)

    @cached_property
    def _slope(self) -> BufferedFunction:
        """The derivative along a direction, interpreted."""
        import casadi

        e = self._equations
        chosen = [e.parameter[index] for index in self._chosen]
        variables = casadi.vertcat(e.state, e.algebraic, *chosen)
        direction = casadi.SX.sym("direction", variables.numel())
        slope = casadi.densify(ops.derivative(self._results, variables, direction))
        inputs = [e.time, e.state, e.algebraic, e.parameter, direction]
        return BufferedFunction(casadi.Function("slope", inputs, [slope]))

    def total(
        self, time: float, state: Vector, unknowns: Vector, parameters: Vector
    ) -> TotalDerivatives:
        """Return the derivatives along closed loops.

        With 0 = g(x, z): dz/dx = -(∂g/∂z)⁻¹ ∂g/∂x and df/dx = ∂f/∂x + ∂f/∂z dz/dx; by
        parameters alike.

        Raises
        ------
        NumericalError
            If the loops are singular at this point.
        """
        n, m = len(self._equations.states), len(self._equations.unknowns)
        partial = self._partial(time, state, unknowns, parameters)
        by_unknown, by_known = partial[:, n : n + m], np.delete(partial, slice(n, n + m), axis=1)
        try:
            solved = np.linalg.solve(by_unknown[n : n + m], by_known[n : n + m])
        except np.linalg.LinAlgError:
            raise NumericalError(
                f"the loops of model '{self._equations.name}' are singular at t = {time:.9g} s; "
                "no derivative along their motions exists there"
            ) from None
        follow = -np.asarray(solved, dtype=float)
        with np.errstate(over="ignore", invalid="ignore"):  # callers check what is not finite
            total = by_known + by_unknown @ follow
        return TotalDerivatives(
            total[:n, :n],
            follow[:, :n],
            total[n + m :, :n],
            total[:n, n:],
            follow[:, n:],
            total[n + m :, n:],
        )

    def _partial(self, *point: Any) -> Vector:
        """Return ∂(rate, residual, output)/∂(x, z, p), of p the chosen parameters."""
        directions = np.eye(
            len(self._equations.states) + len(self._equations.unknowns) + len(self._chosen)
        )
        machine = self._machine if self._left <= 0 else None
        if machine is not None:
            time, state, unknowns, parameters = point
            given = np.concatenate([state, unknowns, parameters[self._chosen]])
            numbers = np.append(parameters, time)
            return machine.slopes(given[None], numbers)[1][0, :, :-1]
        self._left -= len(directions)
        columns = [self._slope(*point, direction)[0] for direction in directions]
        return np.stack(columns, axis=1) if columns else np.zeros((self._results.numel(), 0))


def _compiled(equations: Equations, results: Any, chosen: list[int]) -> PointCode | None:
    """Return compiled derivatives of a large model, where a compiler works."""
    import casadi

    e = equations
    columns = len(e.states) + len(e.unknowns) + len(chosen)
    inputs = [e.time, e.state, e.algebraic, e.parameter]
    if columns * operations_in(casadi.Function("results", inputs, [results])) < _WORTH_COMPILING:
        return None
    numbers = [e.parameter[k] for k in range(len(e.parameters))]
    point = casadi.vertcat(e.state, e.algebraic, *[numbers[k] for k in chosen])
    for k in chosen:
        numbers[k] = casadi.SX.sym("moved", 1)
    try:
        return PointCode(
            results, point, casadi.vertcat(*numbers, e.time), e.tables, index=len(numbers)
        )
    except CompilationError:
        return None
