"""Coordinate partitioning: which coordinates the loops determine, and in which order.

Gaussian elimination with full pivoting of the constraint Jacobian at the assembled
configuration (Wehage, Haug 1982; book, chapter 4.6.1): pivot columns become dependent
coordinates, rows left over are redundant.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.symbolic.elimination import triangular_blocks

Array = NDArray[np.float64]
RANK_TOLERANCE = 1e-9


@dataclass(frozen=True)
class Redundancy:
    """A row that says nothing new: row + Σ weight · other vanishes in every free column.

    ``rest`` are its entries that do not vanish, {column: entry}, in columns that are not free.
    """

    row: int
    weights: dict[int, float]
    rest: dict[int, float]


@dataclass(frozen=True)
class Partition:
    """Result of the partitioning, as indices of residuals (rows) and coordinates (columns).

    ``pairs`` matches each kept residual with the dependent coordinate it determines, in the
    order of elimination within ``blocks``; ``blocks`` lists the pairs of each block in the
    order of solution; ``redundancies`` are the residuals that follow from the others.
    ``smallest_pivot`` was met in column ``weakest``, -1 if there is none.
    """

    blocks: tuple[tuple[tuple[int, int], ...], ...]
    redundancies: tuple[Redundancy, ...]
    smallest_pivot: float
    weakest: int = -1

    @property
    def pairs(self) -> list[tuple[int, int]]:
        """All (residual, dependent coordinate) pairs in the order of solution."""
        return [pair for block in self.blocks for pair in block]

    @property
    def redundant(self) -> tuple[int, ...]:
        """The residuals that follow from the others."""
        return tuple(item.row for item in self.redundancies)

    @property
    def columns(self) -> list[int]:
        """The dependent coordinates in the order of solution."""
        return [column for _, column in self.pairs]


@dataclass(frozen=True)
class Choice:
    """Partition of the coordinates by the holonomic rows, of the rates by all rows.

    They are one and the same where no constraint is non-holonomic; else every dependent
    coordinate has a dependent rate, and some more rates are dependent.
    """

    positions: Partition
    rates: Partition


def choose(
    jacobian: Array,
    structure: Sequence[set[int]],
    must: Sequence[int],
    may: Sequence[int],
    names: Sequence[str],
    *,
    holonomic: int | None = None,
) -> Choice:
    """Choose the dependent coordinates and rates.

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
    holonomic
        Number of the first rows that are holonomic; all if None.

    Raises
    ------
    InputError
        If a coordinate declared dependent is not determined by the loops.
    """
    count = len(jacobian) if holonomic is None else holonomic
    work = _Elimination(jacobian)
    groups = [list(must), list(may)]
    for candidates in groups:
        work.eliminate(list(range(count)), candidates)
    first = work.partition(jacobian, structure, range(count), groups)
    if count < len(jacobian):
        for candidates in groups:
            work.eliminate(list(range(count, len(jacobian))), candidates)
    if groups[0]:
        listed = ", ".join(f"'{names[c]}'" for c in groups[0])
        raise InputError(
            f"the loops do not determine {listed} at the assembled configuration; "
            "declare other coordinates dependent or leave the choice to the program",
            about=[names[c] for c in groups[0]],
        )
    if count == len(jacobian):
        return Choice(first, first)
    return Choice(first, work.partition(jacobian, structure, range(len(jacobian)), groups))


def best_pairs(
    jacobian: Array, may: Sequence[int], *, holonomic: int, must: Sequence[int] = ()
) -> list[tuple[int, int]]:
    """Return the (row, column) pairs that :func:`choose` finds where all may be chosen.

    Those that ``must`` are chosen first, as there.
    """
    work = _Elimination(jacobian)
    groups = [list(must), [column for column in may if column not in must]]
    for rows in (range(holonomic), range(holonomic, len(jacobian))):
        for candidates in groups:
            work.eliminate(list(rows), candidates)
    return work.pairs


def independent_rows(jacobian: Array) -> list[int]:
    """Return rows that are linearly independent and span all, by pivoted QR of the scaled rows.

    There are none where rows are so large that they cannot be compared, as in runs that diverge.
    """
    with np.errstate(all="ignore"):
        lengths = np.linalg.norm(jacobian, axis=1, keepdims=True)
    if not np.isfinite(lengths).all():
        return []
    scaled = jacobian / np.where(lengths > RANK_TOLERANCE, lengths, np.inf)
    (rows,) = np.nonzero(lengths[:, 0] > RANK_TOLERANCE)
    if 0 < len(rows) <= jacobian.shape[1]:
        least = np.linalg.svd(scaled[rows], compute_uv=False)[-1]
        if least > RANK_TOLERANCE:  # no diagonal element of the triangle is less
            return [int(k) for k in rows]
    from scipy.linalg import qr

    triangle, order = qr(scaled.T, mode="r", pivoting=True)
    rank = int(np.sum(np.abs(np.diag(triangle)) > RANK_TOLERANCE))
    return sorted(int(k) for k in order[:rank])


class _Elimination:
    """Gaussian elimination with full pivoting, which remembers how rows were combined."""

    def __init__(self, jacobian: Array) -> None:
        self._scale = max(1.0, float(np.abs(jacobian).max(initial=0.0)))
        self._work = jacobian.copy()
        self._combined = np.eye(len(jacobian))
        self._open = list(range(len(jacobian)))
        self.pairs: list[tuple[int, int]] = []
        self._pivots: list[float] = []

    def eliminate(self, rows: list[int], candidates: list[int]) -> None:
        """Pair rows with candidates, which are taken from their list, as long as pivots last."""
        rows = [row for row in rows if row in self._open]
        entries = _Sizes(self._work, rows, candidates)
        while rows and candidates:
            size, row, column = entries.first_largest()
            if size <= RANK_TOLERANCE * self._scale:
                break
            rows.remove(row)
            candidates.remove(column)
            self._open.remove(row)
            self._pivots.append(size)
            self.pairs.append((row, column))
            others = np.array(self._open, dtype=int)
            others = others[self._work[others, column] != 0.0]
            factors = (self._work[others, column] / self._work[row, column])[:, None]
            self._work[others] -= self._work[row] * factors
            self._combined[others] -= self._combined[row] * factors
            entries.renew(row, column, others)

    def partition(
        self,
        jacobian: Array,
        structure: Sequence[set[int]],
        rows: Iterable[int],
        free: Sequence[Sequence[int]],
    ) -> Partition:
        """Return what has been found, with the rows among these that were left over."""
        blocks = _blocks(jacobian, structure, self.pairs)
        moving = {*(c for group in free for c in group), *(c for _, c in self.pairs)}
        left = tuple(self._redundancy(row, moving) for row in rows if row in self._open)
        weakest = int(np.argmin(self._pivots)) if self._pivots else -1
        if weakest < 0:
            return Partition(tuple(blocks), left, 1.0)
        return Partition(tuple(blocks), left, self._pivots[weakest], self.pairs[weakest][1])

    def _redundancy(self, row: int, free: set[int]) -> Redundancy:
        weights = {
            int(k): float(self._combined[row, k])
            for k in np.flatnonzero(np.abs(self._combined[row]) > RANK_TOLERANCE)
            if k != row
        }
        rest = {
            int(c): float(self._work[row, c])
            for c in np.flatnonzero(np.abs(self._work[row]) > RANK_TOLERANCE * self._scale)
            if c not in free
        }
        return Redundancy(row, weights, rest)


class _Sizes:
    """Magnitudes of the entries that may become pivots, with the largest of each row kept."""

    def __init__(self, work: Array, rows: Sequence[int], columns: Sequence[int]) -> None:
        self._work, self._rows = work, np.array(rows, dtype=int)
        self._columns = np.array(columns, dtype=int)
        self._place = {row: k for k, row in enumerate(rows)}
        self._sizes = np.abs(work[np.ix_(self._rows, self._columns)])
        self._is_taken = np.zeros(len(columns), dtype=bool)
        self._largest = self._sizes.max(axis=1, initial=0.0)

    def first_largest(self) -> tuple[float, int, int]:
        """Return size, row and column of the first entry within rounding of the largest."""
        i = _first_largest(self._largest)
        enough = self._largest.max() * _NEARLY
        j = int(np.flatnonzero(self._sizes[i] >= enough)[0])
        return float(self._sizes[i, j]), int(self._rows[i]), int(self._columns[j])

    def renew(self, row: int, column: int, changed: NDArray[np.intp]) -> None:
        """Take row and column of a pivot away, and look at the rows that changed."""
        taken = self._columns == column
        self._is_taken |= taken
        self._sizes[:, taken] = 0.0
        places = [self._place[other] for other in changed.tolist() if other in self._place]
        found = np.abs(self._work[np.ix_(self._rows[places], self._columns)])
        self._sizes[places] = np.where(self._is_taken, 0.0, found)
        self._largest[places] = self._sizes[places].max(axis=1, initial=0.0)
        self._sizes[self._place[row]] = self._largest[self._place[row]] = 0.0


_NEARLY = 1.0 - 1e-6
"""Part of the largest size from which entries are as good, so that symmetry breaks alike."""


def _first_largest(block: Array) -> int:
    """Return the first entry within rounding of the largest, so that symmetry breaks alike."""
    return int(np.flatnonzero(block.ravel() >= block.max() * _NEARLY)[0])


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
    work = jacobian[np.ix_(rows, columns)]
    rows, columns, order = list(rows), list(columns), []
    while rows:
        i, j = divmod(_first_largest(np.abs(work)), len(columns))
        order.append((rows.pop(i), columns.pop(j)))
        pivot = work[i]
        work = np.delete(work, i, axis=0)
        work -= pivot * (work[:, j] / pivot[j])[:, None]
        work = np.delete(work, j, axis=1)
    return order
