"""Symmetric saddle-point systems [[M, Jᵀ], [J, 0]] of constrained motion, solved sparsely.

M is eliminated first, in an order of least degree, which on a tree has no fill; what is left for
the constraints, J M⁻¹ Jᵀ, is positive definite. Small ones are factorised by unrolled L D Lᵀ;
large ones are handed to a sparse L D Lᵀ at run time, as a call.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.elimination import Rows
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.sparse_rows import matrix_of

MOST_UNROLLED = 5_000
"""Products of a factorisation up to which it is unrolled; a net of 8 by 8 points has as many."""

_CALLED = "sparse_ldl"


@dataclass(frozen=True)
class _Pivot:
    """One step of the elimination: its unknown, the inverse of its pivot and the factors."""

    place: int
    inverse: Scalar
    factors: dict[int, Scalar]


class SaddlePoint:
    """The factorised matrix of a constrained motion.

    Unknowns are the accelerations of M first, then one for each row of J. ``is_unrolled`` tells
    whether all is written out, without calls.
    """

    def __init__(self, mass: Rows, jacobian: Rows) -> None:
        """Factorise.

        Parameters
        ----------
        mass
            Rows of M with both triangles, shape (n, n), positive definite.
        jacobian
            Rows of J, shape (m, n), independent of each other.
        """
        n = len(mass)
        self._n, self._size = n, n + len(jacobian)
        matrix = [dict(row) for row in mass] + [dict(row) for row in jacobian]
        for k, row in enumerate(jacobian):
            for column, entry in row.items():
                matrix[column][n + k] = entry
        self._pivots = _eliminate(matrix, range(n))
        rest = range(n, self._size)
        self.is_unrolled = _products(matrix, rest) <= MOST_UNROLLED
        self._matrix = matrix
        if self.is_unrolled:
            self._pivots += _eliminate(matrix, rest)

    def solve(self, right: Sequence[Scalar]) -> list[Scalar]:
        """Return the unknowns for a right-hand side, shape (n + m,)."""
        side = list(right)
        for pivot in self._pivots:
            value = side[pivot.place]
            for j, factor in pivot.factors.items():
                side[j] = side[j] - factor * value
        found: list[Scalar] = [ops.scalar(0.0)] * self._size
        if not self.is_unrolled:
            found[self._n :] = self._by_call(side[self._n :])
        for pivot in reversed(self._pivots):
            value = side[pivot.place] * pivot.inverse
            for j, factor in pivot.factors.items():
                value = value - factor * found[j]
            found[pivot.place] = value
        return found

    def _by_call(self, side: list[Scalar]) -> list[Scalar]:
        """Solve for the constraints by a call; the matrix left for them is negative definite."""
        import casadi

        n, count = self._n, self._size - self._n
        rows = [{j - n: -v for j, v in row.items()} for row in self._matrix[n:]]
        matrix = casadi.SX(matrix_of(rows, count))
        entries = casadi.reshape(matrix.nz[:], matrix.nnz(), 1)
        found = -_solver(matrix.sparsity())(entries, ops.column(side))
        return [found[k] for k in range(count)]


def _solver(sparsity: Any) -> Any:
    """Return the function (entries, right-hand side) -> solution of a definite matrix."""
    import casadi

    entries = casadi.MX.sym("entries", sparsity.nnz())
    side = casadi.MX.sym("side", sparsity.size1())
    solution = casadi.solve(casadi.MX(sparsity, entries), side, "ldl")
    name = f"{_CALLED}_{sparsity.size1()}_{sparsity.hash() % 2**32}"
    return casadi.Function(name, [entries, side], [solution], {"never_inline": True})


def _eliminate(matrix: Rows, places: range) -> list[_Pivot]:
    """Eliminate some unknowns of a symmetric matrix, in place; return the steps."""
    pivots = []
    remaining = set(places)
    while remaining:
        place = min(remaining, key=lambda i: (len(matrix[i]), i))
        row = matrix[place]
        inverse = 1.0 / row.pop(place)
        factors = {j: value * inverse for j, value in row.items()}
        for j, factor in factors.items():
            other = matrix[j]
            other.pop(place)
            for k in factors:
                if k <= j:
                    value = -(factor * row[k])
                    other[k] = other[k] + value if k in other else value
                    matrix[k][j] = other[k]
        pivots.append(_Pivot(place, inverse, factors))
        remaining.discard(place)
    return pivots


def _products(matrix: Rows, places: range) -> int:
    """Return the number of products that eliminating some unknowns takes, counted up to a limit."""
    known = {i: {j for j in matrix[i] if j != i} for i in places}
    remaining, total = set(places), 0
    while remaining and total <= MOST_UNROLLED:
        place = min(remaining, key=lambda i: (len(known[i]), i))
        others = known[place]
        total += len(others) * (len(others) + 3) // 2
        for j in others:
            known[j] |= others
            known[j] -= {j, place}
        remaining.discard(place)
    return total
