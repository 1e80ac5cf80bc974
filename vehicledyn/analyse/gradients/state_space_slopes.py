"""Derivatives of linear systems in state space, made proper as the systems themselves are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class StateSpaceSlopes:
    """Derivatives of A, B, C and D by parameters, each (n_parameters, n_rows, n_columns)."""

    a: Floats
    b: Floats
    c: Floats
    d: Floats


def proper_slopes(
    matrix: Floats,
    moved: Floats,
    values: Sequence[Floats],
    changes: Sequence[Floats],
    orders: Sequence[int],
) -> StateSpaceSlopes:
    """Return the derivatives of what :func:`~vehicledyn.analyse.state_space.proper` returns.

    An input of order zero enters by B_0 + A (B_1 + A B_2) and D_0 + C (B_1 + A B_2).

    Parameters
    ----------
    matrix
        A above C, shape (n_states + n_outputs, n_states).
    moved
        Its derivatives, shape (n_parameters, n_states + n_outputs, n_states).
    values
        B above D of each input by powers of s, shape (3, n_states + n_outputs).
    changes
        Their derivatives, shape (n_parameters, 3, n_states + n_outputs).
    orders
        The order that each input is taken of.
    """
    n, n_rows = matrix.shape[1], len(matrix) - matrix.shape[1]
    n_all = n + sum(orders)
    whole = np.zeros((len(moved), n_all + n_rows, n_all + len(values)))
    rows = [*range(n), *range(n_all, n_all + n_rows)]
    for k, change in enumerate(moved):
        whole[k][np.ix_(rows, range(n))] = change
    place = n
    for number, (value, change, order) in enumerate(zip(values, changes, orders, strict=True)):
        last = n_all + number
        if order == 0:
            whole[:, rows, last] = _shifted(matrix, moved, value, change)
            continue
        for power in range(order):
            whole[:, rows, place + power] = change[:, power]
        whole[:, rows, last] = change[:, order]
        place += order
    return StateSpaceSlopes(
        whole[:, :n_all, :n_all],
        whole[:, :n_all, n_all:],
        whole[:, n_all:, :n_all],
        whole[:, n_all:, n_all:],
    )


def _shifted(matrix: Floats, moved: Floats, value: Floats, change: Floats) -> Floats:
    """Return the derivatives of B_0 + A w above D_0 + C w with w = B_1 + A B_2."""
    n = matrix.shape[1]
    shift = value[1, :n] + matrix[:n] @ value[2, :n]
    by_shift = change[:, 1, :n] + moved[:, :n] @ value[2, :n] + change[:, 2, :n] @ matrix[:n].T
    found = change[:, 0] + moved @ shift + by_shift @ matrix.T
    return np.asarray(found, dtype=float)
