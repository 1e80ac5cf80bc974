"""Zero eigenvalues of a matrix with their chains, distinguished before anything is computed.

A free body has a double zero with one eigenvector: computed like other eigenvalues it would
come out as a pair as large as the square root of the rounding error. The staircase below finds
the null space, leaves it out, finds that of what remains, and so on. The dimensions d_1 ≥ d_2 …
are the numbers of Jordan chains of at least that length.

References
----------
Golub, Wilkinson (1976), Ill-conditioned eigensystems and the computation of the Jordan
canonical form, SIAM Review 18(4), 578-619.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from vehicledyn.kernel.engine import Vector

RANK = 1e-11
"""Part of the largest singular value, rows scaled alike, below which one counts as zero [1]."""

_PIVOT = 1e-6


@dataclass(frozen=True)
class StaircaseStep:
    """One step of the staircase: null space N, orthonormal complement C, coupling Nᵀ A C."""

    null: Vector
    complement: Vector
    coupling: Vector


@dataclass(frozen=True)
class Staircase:
    """A matrix with its zeros taken away: ``core`` has none, ``steps`` lead back."""

    core: Vector
    steps: tuple[StaircaseStep, ...]
    scale: Vector

    @property
    def zeros(self) -> int:
        """How many eigenvalues are zero."""
        return sum(step.null.shape[1] for step in self.steps)

    def right(self, eigenvalue: complex, vector: Any) -> Any:
        """Return the right eigenvector of the matrix from one of the core, λ ≠ 0."""
        for step in reversed(self.steps):
            inside = step.null @ (step.coupling @ vector) / eigenvalue
            vector = step.complement @ vector + inside
        return self.scale * vector

    def left(self, vector: Any) -> Any:
        """Return the left eigenvector of the matrix from one of the core, λ ≠ 0."""
        for step in reversed(self.steps):
            vector = step.complement @ vector
        return vector / self.scale

    def axes(self) -> Vector:
        """Return orthonormal axes of the balanced matrix: those of the zeros, then the core's."""
        outer, columns = np.eye(len(self.scale)), []
        for step in self.steps:
            columns.append(outer @ step.null)
            outer = outer @ step.complement
        return np.hstack([*columns, outer])

    def chains(self) -> tuple[Vector, list[int]]:
        """Return a basis of all w with Aᵏ w = 0, by columns, and the level k of each column."""
        columns, levels = [], []
        for level, step in enumerate(self.steps):
            basis = step.null
            for before in reversed(self.steps[:level]):
                basis = before.complement @ basis
            columns.append(self.scale[:, None] * basis)
            levels += [level + 1] * basis.shape[1]
        size = len(self.scale)
        return (np.hstack(columns) if columns else np.zeros((size, 0))), levels


def staircase(matrix: Vector) -> Staircase:
    """Return a matrix with its zero eigenvalues taken away.

    Parameters
    ----------
    matrix
        Shape (n, n); entries that are nothing but rounding are best made zero before.
    """
    from scipy.linalg import matrix_balance

    balanced, (scale, _) = matrix_balance(matrix, permute=False, separate=True)
    steps: list[StaircaseStep] = []
    while balanced.size:
        null, complement = _null_space(balanced)
        if not null.shape[1]:
            break
        inside = balanced @ complement
        steps.append(StaircaseStep(null, complement, null.T @ inside))
        balanced = complement.T @ inside
    return Staircase(balanced, tuple(steps), scale)


def named_chains(
    basis: Vector, levels: Sequence[int], preferred: Sequence[int]
) -> list[tuple[int, Vector, int]]:
    """Return the chains as (pivot, vector, level), each vector 1 at its pivot.

    It is 0 at the pivots of its own and of lower levels; to vectors of lower levels those of
    higher ones are not added, as that would raise their level.

    Parameters
    ----------
    basis, levels
        As :meth:`Staircase.chains` gives them.
    preferred
        States to take as pivots first, where they take part.
    """
    part = basis / np.abs(basis).max(axis=0, initial=1e-300)
    pivots: list[int] = []
    for first in range(part.shape[1]):
        last = max(k for k, level in enumerate(levels) if level == levels[first]) + 1
        row, column = _next_pivot(part[:, first:last], pivots, preferred)
        part[:, [first, first + column]] = part[:, [first + column, first]]
        part[:, first] /= part[row, first]
        begin = next(k for k, level in enumerate(levels) if level == levels[first])
        for other in range(begin, part.shape[1]):
            if other != first:
                part[:, other] -= part[row, other] * part[:, first]
        pivots.append(row)
    return [(pivot, part[:, k], levels[k]) for k, pivot in enumerate(pivots)]


def _null_space(matrix: Vector) -> tuple[Vector, Vector]:
    """Return orthonormal bases of the null space and of its complement."""
    size = np.abs(matrix).max(axis=1, keepdims=True)
    rows = matrix / np.where(size > 0.0, size, 1.0)
    _, values, turned = np.linalg.svd(rows)
    rank = int((values > RANK * max(values[0], 1e-300)).sum())
    return turned[rank:].T.copy(), turned[:rank].T.copy()


def _next_pivot(part: Vector, pivots: list[int], preferred: Sequence[int]) -> tuple[int, int]:
    """Return row and column of the next pivot of some columns."""
    for row in preferred:
        if row not in pivots:
            column = int(np.argmax(np.abs(part[row])))
            if abs(part[row, column]) > _PIVOT:
                return row, column
    rest = np.abs(part)
    rest[pivots] = 0.0
    row, column = divmod(int(np.argmax(rest)), rest.shape[1])
    return row, column
