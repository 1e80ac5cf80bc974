"""Coordinate partitioning: which coordinates the loops determine, and in which order.

Gaussian elimination with full pivoting of the constraint Jacobian at the assembled
configuration (Wehage, Haug 1982; book, chapter 4.6.1): pivot columns become dependent
coordinates, rows left over are redundant.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.symbolic.elimination import triangular_blocks

Array = NDArray[np.float64]
RANK_TOLERANCE = 1e-9


@dataclass(frozen=True)
class Partition:
    """Result of the partitioning, as indices of residuals (rows) and coordinates (columns).

    ``pairs`` matches each kept residual with the dependent coordinate it determines, in the
    order of elimination within ``blocks``; ``blocks`` lists the pairs of each block in the
    order of solution; ``redundant`` are the residuals that follow from the others.
    """

    blocks: tuple[tuple[tuple[int, int], ...], ...]
    redundant: tuple[int, ...]
    smallest_pivot: float

    @property
    def pairs(self) -> list[tuple[int, int]]:
        """All (residual, dependent coordinate) pairs in the order of solution."""
        return [pair for block in self.blocks for pair in block]


def choose(
    jacobian: Array,
    structure: Sequence[set[int]],
    must: Sequence[int],
    may: Sequence[int],
    names: Sequence[str],
) -> Partition:
    """Choose the dependent coordinates.

    Parameters
    ----------
    jacobian
        Constraint Jacobian at the assembled configuration, shape (n_residuals, n_coordinates).
    structure
        Columns of the structural nonzeros of each row.
    must, may
        Columns declared dependent, and those left to the choice.
    names
        Names of the coordinates.

    Raises
    ------
    InputError
        If a coordinate declared dependent is not determined by the loops.
    """
    scale = max(1.0, float(np.abs(jacobian).max(initial=0.0)))
    work = jacobian.copy()
    rows = list(range(len(work)))
    pairs: list[tuple[int, int]] = []
    pivots: list[float] = []
    for candidates in (list(must), list(may)):
        while rows and candidates:
            block = np.abs(work[np.ix_(rows, candidates)])
            i, j = np.unravel_index(int(_first_largest(block)), block.shape)
            if block[i, j] <= RANK_TOLERANCE * scale:
                break
            row, column = rows.pop(int(i)), candidates.pop(int(j))
            pivots.append(float(block[i, j]))
            pairs.append((row, column))
            for other in rows:
                work[other] -= work[row] * (work[other, column] / work[row, column])
        if candidates and candidates[0] in set(must):
            listed = ", ".join(f"'{names[c]}'" for c in candidates)
            raise InputError(
                f"the loops do not determine {listed} at the assembled configuration; "
                "declare other coordinates dependent or leave the choice to the program"
            )
    blocks = _blocks(jacobian, structure, pairs)
    return Partition(tuple(blocks), tuple(rows), min(pivots, default=1.0))


def _first_largest(block: Array) -> int:
    """Return the first entry within rounding of the largest, so that symmetry breaks alike."""
    return int(np.flatnonzero(block.ravel() >= block.max() * (1.0 - 1e-6))[0])


def _blocks(
    jacobian: Array, structure: Sequence[set[int]], pairs: list[tuple[int, int]]
) -> list[tuple[tuple[int, int], ...]]:
    """Group the pairs into the diagonal blocks of a block-triangular system."""
    position = {column: k for k, (_, column) in enumerate(pairs)}
    pattern = [{position[c] for c in structure[row] if c in position} for row, _ in pairs]
    grouped = []
    for block in triangular_blocks(pattern):
        rows, columns = [pairs[k][0] for k in block], [pairs[k][1] for k in block]
        grouped.append(tuple(_pivot_order(jacobian, rows, columns)))
    return grouped


def _pivot_order(jacobian: Array, rows: list[int], columns: list[int]) -> list[tuple[int, int]]:
    """Return full-pivoting pairs of one block."""
    work = jacobian.copy()
    rows, columns, order = list(rows), list(columns), []
    while rows:
        block = np.abs(work[np.ix_(rows, columns)])
        i, j = np.unravel_index(_first_largest(block), block.shape)
        row, column = rows.pop(int(i)), columns.pop(int(j))
        order.append((row, column))
        for other in rows:
            work[other] -= work[row] * (work[other, column] / work[row, column])
    return order
