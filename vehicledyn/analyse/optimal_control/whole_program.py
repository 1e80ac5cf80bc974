"""Rows of an optimal-control problem as a nonlinear program with a sparse Jacobian and Hessian."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.interior_point import NonlinearProgram, Pattern
from vehicledyn.analyse.optimal_control.rows import OBJECTIVE, BoundedRows

Floats = NDArray[np.float64]


def whole_program(rows: BoundedRows, bounds: tuple[Floats, Floats]) -> NonlinearProgram:
    """Return the program whose first row is least where the others keep their bounds.

    ``bounds`` are those of the variables, each of shape (n,).
    """
    n = rows.scale.size
    columns = np.repeat(np.arange(n), np.diff(rows.slopes.starts))
    in_objective = rows.slopes.rows == OBJECTIVE
    starts = np.searchsorted(columns[~in_objective], np.arange(n + 1))

    def values(x: Floats) -> tuple[float, Floats]:
        found = rows.values(x)
        return float(found[OBJECTIVE]), found[1:]

    def slopes(x: Floats) -> tuple[Floats, Floats]:
        entries, gradient = rows.jacobian(x), np.zeros(n)
        gradient[columns[in_objective]] = entries[in_objective]
        return gradient, entries[~in_objective]

    def hessian(x: Floats, of_objective: float, of_rows: Floats) -> Floats:
        return rows.hessian(x, np.concatenate([[of_objective], of_rows]))

    return NonlinearProgram(
        bounds,
        rows.bounds,
        values,
        slopes,
        Pattern(rows.slopes.rows[~in_objective] - 1, starts),
        hessian,
        Pattern(rows.bends.rows, rows.bends.starts),
    )
