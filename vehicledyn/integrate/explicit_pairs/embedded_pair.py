"""Coefficients of an embedded explicit pair: all that a new method of this kind declares."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

Row = tuple[float, ...]


@dataclass(frozen=True)
class EmbeddedPair:
    """An explicit Runge-Kutta pair whose last stage is the first of the next step.

    Attributes
    ----------
    order, embedded_order
        Orders of the result and of the one that the error is taken from.
    nodes
        Times of the stages c over the step, one a stage.
    stages
        Rows of the strictly lower triangle a, the first one empty.
    weights
        Weights b of the result.
    error
        Weights of the error b - b̂, with one more for the rates at the end of the step.
    dense
        Coefficients of θ, θ², ... in the weights at the part θ of the step, one row for each of
        the stages and the rates at the end.
    """

    order: int
    embedded_order: int
    nodes: Row
    stages: tuple[Row, ...]
    weights: Row
    error: Row
    dense: tuple[Row, ...]

    def solver_class(self) -> type[Any]:
        """Return the class of SciPy's solvers that steps with these coefficients."""
        import numpy as np
        from scipy.integrate import RK45  # takes a good part of a second

        count = len(self.weights)
        stages = np.zeros((count, count))
        for k, row in enumerate(self.stages):
            stages[k, : len(row)] = row
        facts = {
            "order": self.order,
            "error_estimator_order": self.embedded_order,
            "n_stages": count,
            "A": stages,
            "B": np.array(self.weights),
            "C": np.array(self.nodes),
            "E": np.array(self.error),
            "P": np.array(self.dense),
        }
        return type("EmbeddedPairSolver", (RK45,), facts)
