"""Exact derivatives of rates, residuals and outputs, also through the algebraic unknowns.

Columns come from one forward derivative, evaluated for each unit direction: deriving it costs
as much as three times the equations, whatever the number of states.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.solve.engine import Vector
from vehicledyn.solve.interpreted import BufferedFunction
from vehicledyn.symbolic.equations import Equations


@dataclass(frozen=True)
class TotalDerivatives:
    """Derivatives along the motions that keep the loops closed.

    ``rates`` dẋ/dx (n_states, n_states), ``unknowns`` dz/dx (n_unknowns, n_states) and
    ``outputs`` dy/dx (n_channels, n_states).
    """

    rates: Vector
    unknowns: Vector
    outputs: Vector


class Derivatives:
    """Evaluates the derivatives of some equations at any point, for any parameters."""

    def __init__(self, equations: Equations) -> None:
        """Derive the directional derivative."""
        import casadi

        e = self._equations = equations
        results = casadi.cse(
            casadi.densify(casadi.vertcat(e.rate, e.residual, e.output))
            if e.states or e.unknowns or e.channels
            else casadi.SX(0, 1)
        )
        variables = casadi.vertcat(e.state, e.algebraic)
        direction = casadi.SX.sym("direction", variables.numel())
        slope = casadi.densify(casadi.jtimes(results, variables, direction))
        inputs = [e.time, e.state, e.algebraic, e.parameter, direction]
        self._slope = BufferedFunction(casadi.Function("slope", inputs, [slope]))

    def total(
        self, time: float, state: Vector, unknowns: Vector, parameters: Vector
    ) -> TotalDerivatives:
        """Return the derivatives along closed loops.

        With 0 = g(x, z): dz/dx = -(∂g/∂z)⁻¹ ∂g/∂x and df/dx = ∂f/∂x + ∂f/∂z dz/dx.

        Raises
        ------
        NumericalError
            If the loops are singular at this point.
        """
        n, m = len(self._equations.states), len(self._equations.unknowns)
        partial = self._partial(time, state, unknowns, parameters)
        by_state, by_unknown = partial[:, :n], partial[:, n:]
        try:
            solved = np.linalg.solve(by_unknown[n : n + m], by_state[n : n + m])
        except np.linalg.LinAlgError:
            raise NumericalError(
                f"the loops of model '{self._equations.name}' are singular at t = {time:.9g} s; "
                "no derivative along their motions exists there"
            ) from None
        follow = -np.asarray(solved, dtype=float)
        total = by_state + by_unknown @ follow
        return TotalDerivatives(total[:n], follow, total[n + m :])

    def _partial(self, *point: Any) -> Vector:
        """Return ∂(rate, residual, output)/∂(x, z)."""
        size = len(self._equations.states) + len(self._equations.unknowns)
        columns = [self._slope(*point, direction)[0] for direction in np.eye(size)]
        n_rows = size + len(self._equations.channels)
        return np.stack(columns, axis=1) if columns else np.zeros((n_rows, 0))
