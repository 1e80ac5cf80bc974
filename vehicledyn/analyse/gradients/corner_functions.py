"""Values and slopes of the functions whose signs choose between branches of the equations."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.codegen.passes.branch_functions import BranchFunctions
from vehicledyn.kernel.interpreted import BufferedFunction

Array = NDArray[np.float64]


class CornerFunctions:
    """The functions of a model that change along a motion, at single points.

    ``is_table`` (count,) says which are places in tables, counted in cells.

    Parameters
    ----------
    branches
        The functions.
    """

    def __init__(self, branches: BranchFunctions) -> None:
        self._branches, self.is_table = branches, branches.is_table
        self._at = BufferedFunction(branches.function)
        self._slopes: dict[int, Any] = {}

    @property
    def count(self) -> int:
        """Number of functions."""
        return self._branches.count

    def at(self, time: float, state: Array, unknowns: Array, parameters: Array) -> Array:
        """Return the values at a point, shape (count,)."""
        (found,) = self._at(time, state, unknowns, parameters)
        return np.array(found, dtype=float).reshape(self.count)

    def slopes(
        self, which: int, time: float, state: Array, unknowns: Array, parameters: Array
    ) -> list[Array]:
        """Return the derivatives of one by time, states, unknowns and parameters, a row each."""
        import casadi

        if which not in self._slopes:
            inputs, row = self._branches.inputs, self._branches.column[which]
            rows = [casadi.densify(casadi.jacobian(row, symbol)) for symbol in inputs]
            self._slopes[which] = casadi.Function("slopes", inputs, rows)
        found = self._slopes[which](time, state, unknowns, parameters)
        return [np.array(row, dtype=float).ravel() for row in found]
