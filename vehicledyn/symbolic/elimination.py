"""Unrolled elimination on sparse symbolic matrices stored as rows of {column: entry}.

Pivots are chosen beforehand, from numbers or from the structure, because an expression cannot
be compared with another.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from vehicledyn.base.errors import InputError
from vehicledyn.symbolic.ops import Scalar

Rows = list[dict[int, Scalar]]


def solve_in_order(
    matrix: Rows, right: list[dict[int, Scalar]], order: Sequence[tuple[int, int]]
) -> list[dict[int, Scalar]]:
    """Return the solution of A X = B by Gaussian elimination with given pivots.

    Parameters
    ----------
    matrix
        Rows of A, shape (n, n).
    right
        Rows of B, any number of columns.
    order
        Pivots (row, column) in the order of elimination, one a row and column.

    Returns
    -------
    list
        Rows of X, indexed by the columns of A.
    """
    rows = [dict(row) for row in matrix]
    sides = [dict(row) for row in right]
    for step, (pivot_row, pivot_column) in enumerate(order):
        inverse = 1.0 / rows[pivot_row][pivot_column]
        for row, _ in order[step + 1 :]:
            entry = rows[row].pop(pivot_column, None)
            if entry is None or _is_zero(entry):
                continue
            factor = entry * inverse
            _subtract(rows[row], rows[pivot_row], factor, skip=pivot_column)
            _subtract(sides[row], sides[pivot_row], factor)
    solution: list[dict[int, Scalar]] = [{} for _ in order]
    for pivot_row, pivot_column in reversed(order):
        total = dict(sides[pivot_row])
        for column, entry in rows[pivot_row].items():
            if column != pivot_column:
                _subtract(total, solution[column], entry)
        inverse = 1.0 / rows[pivot_row][pivot_column]
        solution[pivot_column] = {key: value * inverse for key, value in total.items()}
    return solution


def solve_symmetric(matrix: Rows, right: Sequence[Scalar]) -> list[Scalar]:
    """Return x of A x = b, A symmetric and positive definite, by L D Lᵀ in a sparse order.

    The order is the greedy minimum degree of the structure, which on a tree runs from the
    leaves to the root.

    Parameters
    ----------
    matrix
        Rows of A with both triangles, shape (n, n).
    right
        b, shape (n,).

    Returns
    -------
    list
        x, shape (n,).
    """
    found = condense_symmetric(matrix, right, ()).solution({})
    return [found[k] for k in range(len(matrix))]


@dataclass(frozen=True)
class Condensed:
    """A symmetric system of which some unknowns are eliminated, the kept ones not.

    ``rows`` and ``side`` are what is left for the kept unknowns, at their old places; ``steps``
    are the pivots with their factors, in the order of elimination, ``inverses`` one over them.
    """

    rows: Rows
    side: list[Scalar]
    steps: list[tuple[int, dict[int, Scalar]]]
    inverses: list[Scalar]

    def solution(self, known: dict[int, Scalar]) -> dict[int, Scalar]:
        """Return all unknowns, given the kept ones."""
        found = dict(known)
        for pivot, factors in reversed(self.steps):
            value = self.side[pivot]
            for j, factor in factors.items():
                value = value - factor * found[j]
            found[pivot] = value
        return found


def condense_symmetric(matrix: Rows, right: Sequence[Scalar], keep: Iterable[int]) -> Condensed:
    """Eliminate all unknowns but the kept ones from A x = b, A symmetric.

    Parameters
    ----------
    matrix
        Rows of A with both triangles, shape (n, n); positive definite in the eliminated part.
    right
        b, shape (n,).
    keep
        Unknowns that stay; the order of the others is that of least degree.

    Raises
    ------
    InputError
        If the matrix is singular by its structure.
    """
    remaining = [{j: v for j, v in row.items() if not _is_zero(v)} for row in matrix]
    side = list(right)
    steps: list[tuple[int, dict[int, Scalar]]] = []
    inverses: list[Scalar] = []
    open_rows = set(range(len(matrix))) - set(keep)
    while open_rows:
        pivot = min(open_rows, key=lambda i: (len(remaining[i]), i))
        row = remaining[pivot]
        if pivot not in row:
            raise InputError(f"the matrix is singular: nothing determines its unknown {pivot}")
        inverse = 1.0 / row.pop(pivot)
        factors = {j: value * inverse for j, value in row.items()}
        for j, factor in factors.items():
            remaining[j].pop(pivot)
            side[j] = side[j] - factor * side[pivot]
            for k in factors:
                if k <= j:
                    value = remaining[j].get(k, 0.0) - factor * row[k]
                    remaining[j][k] = value
                    remaining[k][j] = value
        side[pivot] = side[pivot] * inverse
        steps.append((pivot, factors))
        inverses.append(inverse)
        open_rows.discard(pivot)
    return Condensed(remaining, side, steps, inverses)


def transpose(rows: Rows, columns: int) -> Rows:
    """Return the rows of the transposed matrix; ``columns`` is the width of the given one."""
    turned: Rows = [{} for _ in range(columns)]
    for i, row in enumerate(rows):
        for j, value in row.items():
            turned[j][i] = value
    return turned


def triangular_blocks(pattern: Sequence[set[int]]) -> list[list[int]]:
    """Return the strongly connected sets of i -> j in ``pattern[i]``, dependencies first.

    With rows and columns matched (row i is solved for unknown i) these are the diagonal blocks
    of a block-triangular system, in the order of solution (Tarjan 1972).
    """
    index: dict[int, int] = {}
    low: dict[int, int] = {}
    stack: list[int] = []
    blocks: list[list[int]] = []

    def visit(node: int) -> None:
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in sorted(pattern[node]):
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            cut = stack.index(node)
            blocks.append(sorted(stack[cut:]))
            del stack[cut:]

    for node in range(len(pattern)):
        if node not in index:
            visit(node)
    return blocks


def _subtract(
    target: dict[int, Scalar], source: dict[int, Scalar], factor: Scalar, skip: int | None = None
) -> None:
    for key, value in source.items():
        if key == skip or _is_zero(value):
            continue
        target[key] = target.get(key, 0.0) - factor * value


def _is_zero(value: Scalar) -> bool:
    return value == 0.0 if isinstance(value, float | int) else bool(value.is_zero())
