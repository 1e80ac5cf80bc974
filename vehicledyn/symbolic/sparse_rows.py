"""Sparse symbolic matrices and their rows as mappings {column: entry}."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from vehicledyn.symbolic.ops import Scalar, column


def matrix_of(rows: Sequence[dict[int, Scalar]], width: int) -> Any:
    """Return the sparse SX matrix of rows {column: entry}, shape (len(rows), width)."""
    import casadi

    places = sorted((j, i) for i, row in enumerate(rows) for j in row)
    if not places:
        return casadi.SX(len(rows), width)
    columns, found = zip(*places, strict=True)
    pattern = casadi.Sparsity.triplet(len(rows), width, found, columns)
    return casadi.SX(pattern, column([rows[i][j] for j, i in places]))


def rows_of(matrix: Any) -> list[dict[int, Scalar]]:
    """Return the structural nonzeros of an SX matrix as rows of {column: entry}."""
    rows: list[dict[int, Scalar]] = [{} for _ in range(matrix.size1())]
    for (i, j), value in zip(
        zip(*matrix.sparsity().get_triplet(), strict=True), matrix.nonzeros(), strict=True
    ):
        if not value.is_zero():
            rows[i][j] = value
    return rows
