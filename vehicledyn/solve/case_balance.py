"""Equilibria of many cases at once, found from that of a case like them.

Broyden's method: every case starts with the inverse Jacobian of the base case and corrects it by
what its own steps tell, so that nothing needs to be differentiated for it. All sums run in a
fixed order, so a case's result does not depend on its neighbours.

Broyden (1965), Mathematics of Computation 19(92), 577-593, his first method.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vehicledyn.solve.case_rates import CaseRates, Flags
from vehicledyn.solve.engine import Vector

_MOST_STEPS = 40


@dataclass(frozen=True)
class BalancedCases:
    """States and unknowns of cases (one a row), and which of them are solved.

    ``inverses`` are the inverse Jacobians as far as the steps tell them, ``residuals`` the
    largest rates left.
    """

    states: Vector
    unknowns: Vector
    inverses: Vector
    residuals: Vector
    solved: Flags


def balance_cases(
    rates_of: CaseRates,
    *,
    time: float,
    states: Vector,
    unknowns: Vector,
    free: Sequence[int],
    balanced: Sequence[int],
    inverse: Vector,
    tolerance: float,
) -> BalancedCases:
    """Return the points where chosen rates of each case vanish, as far as they are found.

    Parameters
    ----------
    rates_of
        Evaluates the cases.
    time
        Time [s].
    states, unknowns
        Points to start from, shape (n_cases, ...).
    free
        Indices of the states to move.
    balanced
        Indices of the rates that must vanish, as many as free states.
    inverse
        Inverse of ∂rates[balanced]/∂states[free] of a case like these, or of each case.
    tolerance
        Largest rate that counts as zero, in units of the states per s.
    """
    free, balanced = list(free), list(balanced)
    states, unknowns = states.copy(), unknowns.copy()
    n = len(states)
    inverses = np.array(np.broadcast_to(inverse, (n, len(free), len(free))))
    rates, going = rates_of(time, states, unknowns, np.ones(n, dtype=bool))
    residual = rates[:, balanced]
    solved = going & _below(residual, tolerance)
    going &= ~solved
    for _ in range(_MOST_STEPS):
        if not going.any():
            break
        step = -_product(inverses, residual)
        trial, followed = states.copy(), unknowns.copy()
        trial[:, free] += step
        rates, found = rates_of(time, trial, followed, going)
        change = rates[:, balanced] - residual
        states[found], unknowns[found] = trial[found], followed[found]
        residual[found] = rates[found][:, balanced]
        going &= found
        solved |= going & _below(residual, tolerance)
        going &= ~solved
        _correct(inverses, step, change, going)
    largest = np.abs(residual).max(axis=1, initial=0.0)
    return BalancedCases(states, unknowns, inverses, largest, solved)


def _below(residual: Vector, tolerance: float) -> Flags:
    return np.asarray((np.abs(residual) <= tolerance).all(axis=1))


def _product(matrices: Vector, columns: Vector) -> Vector:
    """Return the products of matrices (n, m, m) and columns (n, m), summed column by column."""
    total = np.zeros_like(columns)
    for k in range(columns.shape[1]):
        total += matrices[:, :, k] * columns[:, k, None]
    return total


def _correct(inverses: Vector, step: Vector, change: Vector, chosen: Flags) -> None:
    """Let the inverses of chosen cases map what the rates changed by to the step that was made."""
    matrices, s, y = inverses[chosen], step[chosen], change[chosen]
    mapped = _product(matrices, y)
    row = _product(matrices.transpose(0, 2, 1), s)
    scale = np.zeros(len(s))
    for k in range(s.shape[1]):
        scale += s[:, k] * mapped[:, k]
    usable = np.abs(scale) > 0.0
    factor = np.divide(1.0, scale, out=np.zeros_like(scale), where=usable)
    inverses[chosen] = matrices + ((s - mapped) * factor[:, None])[:, :, None] * row[:, None, :]
