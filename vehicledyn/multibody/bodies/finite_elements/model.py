"""A finite-element model as matrices: mass, stiffness, nodes and what each row stands for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError

Array = NDArray[np.float64]
Sparse = Any
"""A sparse matrix of SciPy, in compressed rows."""

DIRECTIONS = ("x", "y", "z", "rx", "ry", "rz")
_SHOWN = 4
_FARTHEST = 1e6
"""Coordinate that no structure has [m]."""
_LARGEST = 1e30
"""Entry that no matrix has, in kg, m and s."""
_UNLIKE = 1e-9
"""Largest difference of entries that are equal in a symmetric matrix, over the largest entry."""
_RESISTED = 1e-6
"""Largest elastic force that a rigid motion may need, over that of its terms."""


@dataclass(frozen=True, eq=False)
class GeometricStiffness:
    """Stiffness that unit loads give a structure by the stresses they cause in it.

    Parameters
    ----------
    held
        Number of the node that held the structure while it was loaded; 0 where the loads were
        balanced by the mass of the rigid body, so that nothing held it.
    matrices
        Matrix of each load in compressed rows, (n_rows, n_rows), by its name:
        ``acceleration_x`` for the inertia forces of a unit acceleration along x [kg/m],
        ``inertia_y_x`` for those of an acceleration along x that grows with y [kg], both about the
        origin; ``force_7_x`` for a unit force on node 7 along x [1/m].
    """

    held: int
    matrices: Mapping[str, Sparse]


@dataclass(frozen=True, eq=False)
class FiniteElements:
    """Mass, stiffness and damping matrices of a free structure, in SI units.

    Parameters
    ----------
    source
        What messages call it, such as the name of its file.
    numbers
        Number of each node, shape (n,).
    places
        Where the nodes are, shape (n, 3) [m].
    rows
        Number of the node and direction of each row, shape (n_rows, 2): 1 to 3 are displacements
        along x, y and z, 4 to 6 small rotations about them.
    mass, stiffness, damping
        Matrices, sparse or not, shape (n_rows, n_rows); ``damping`` may be None.
    lines
        Where in the source each row is written, for messages; empty where that says nothing.
    geometric
        Geometric stiffness under unit loads; None where axial forces do not stiffen the structure.

    Raises
    ------
    InputError
        If the matrices are not those of a free structure, see :meth:`problems`.
    """

    source: str
    numbers: NDArray[np.int64]
    places: Array
    rows: NDArray[np.int64]
    mass: Sparse
    stiffness: Sparse
    damping: Sparse | None = None
    lines: Sequence[str] = field(default=())
    geometric: GeometricStiffness | None = None

    def __post_init__(self) -> None:
        """Bring the matrices into compressed rows and refuse what no structure has."""
        from scipy.sparse import csr_matrix

        for name in ("mass", "stiffness", "damping"):
            given = getattr(self, name)
            if given is not None:
                object.__setattr__(self, name, csr_matrix(given, dtype=float))
        if self.geometric is not None:
            own = {n: csr_matrix(m, dtype=float) for n, m in self.geometric.matrices.items()}
            object.__setattr__(self, "geometric", GeometricStiffness(self.geometric.held, own))
        for stage in (self._wrong_rows, self._wrong_matrices, self._wrong_body):
            found = stage()
            if found:
                raise InputError("\n".join(f"{self.source}: {line}" for line in found))

    @cached_property
    def index(self) -> dict[int, int]:
        """Place in ``numbers`` of each node."""
        return {int(number): k for k, number in enumerate(self.numbers)}

    @cached_property
    def row_of(self) -> dict[tuple[int, int], int]:
        """Row of each direction (1 to 6) of each node by its number."""
        return {(int(n), int(d)): k for k, (n, d) in enumerate(self.rows)}

    @cached_property
    def translations(self) -> NDArray[np.int64]:
        """Rows of the displacements of each node along x, y and z, shape (n, 3)."""
        return np.array([[self.row_of[int(n), d] for d in (1, 2, 3)] for n in self.numbers])

    @cached_property
    def rigid(self) -> Array:
        """Displacements for unit translations and rotations about the origin, (n_rows, 6)."""
        return rigid_motions(self.places[[self.index[int(n)] for n in self.rows[:, 0]]], self.rows)

    def _wrong_rows(self) -> list[str]:
        count, found = len(self.rows), []
        for name, matrix in self._matrices.items():
            if matrix.shape != (count, count):
                words = f"{name}: has the shape {matrix.shape}, the nodes have {count} directions"
                found.append(f"{words}; give as many rows as directions, or name these in 'dofs'")
        twice = sorted({int(n) for n in self.numbers if (self.numbers == n).sum() > 1})
        if twice:
            found.append(f"nodes: {_listed(twice)} appears twice; give each node one number")
        known = set(map(int, self.numbers))
        lost = [k for k, (n, _) in enumerate(self.rows) if int(n) not in known]
        if lost:
            names = _listed(sorted({int(self.rows[k, 0]) for k in lost}))
            head = f"{self.lines[lost[0]]}: " if len(self.lines) else ""
            found.append(
                f"{head}nodes: missing: the matrices have directions of node {names}, which has no "
                "coordinates; add it to the nodes"
            )
        odd = [k for k, (_, d) in enumerate(self.rows) if not 1 <= d <= len(DIRECTIONS)]
        if odd:
            head = f"{self.lines[odd[0]]}: " if len(self.lines) else ""
            words = f"{head}dofs: direction {self.rows[odd[0], 1]} of node {self.rows[odd[0], 0]}"
            found.append(f"{words}; directions run from 1 (x) to 6 (rotation about z)")
        if len(self.row_of) < count:
            pairs = [(int(n), int(d)) for n, d in self.rows]
            k = next(k for k, pair in enumerate(pairs) if pair in pairs[:k])
            found.append(f"dofs: direction {pairs[k][1]} of node {pairs[k][0]} appears twice")
        if not np.isfinite(self.places).all():
            bad = self.numbers[~np.isfinite(self.places).all(axis=1)]
            found.append(f"nodes: a coordinate of node {_listed(bad)} is no finite number")
        far = self.numbers[(np.abs(self.places) > _FARTHEST).any(axis=1)]
        if len(far):
            found.append(f"nodes: node {_listed(far)} is beyond 1000 km; coordinates are in m")
        bare = [
            int(n) for n in self.numbers if any((int(n), d) not in self.row_of for d in (1, 2, 3))
        ]
        if bare and not (lost or odd):
            found.append(
                f"dofs: node {_listed(bare)} lacks a displacement along x, y or z; leave out nodes "
                "that carry nothing, and hold no direction: the body is to be free"
            )
        return found

    @cached_property
    def _matrices(self) -> dict[str, Sparse]:
        named = {name: getattr(self, name) for name in ("mass", "stiffness", "damping")}
        if self.geometric is not None:
            named |= {f"geometric_{name}": m for name, m in self.geometric.matrices.items()}
        return {name: matrix for name, matrix in named.items() if matrix is not None}

    def _wrong_matrices(self) -> list[str]:
        found = []
        for name, matrix in self._matrices.items():
            if not np.isfinite(matrix.data).all():
                found.append(f"{name}: has an entry that is no finite number")
                continue
            if matrix.nnz and abs(matrix).max() > _LARGEST:
                found.append(f"{name}: has an entry above {_LARGEST:g}; give it in kg, m and s")
                continue
            away = abs(matrix - matrix.T).tocoo()
            size = abs(matrix).max() if matrix.nnz else 0.0
            if away.nnz and away.data.max() > _UNLIKE * size:
                k = int(np.argmax(away.data))
                i, j = sorted((int(away.row[k]), int(away.col[k])))
                found.append(
                    f"{name}: is not symmetric: entry ({i + 1}, {j + 1}) is {matrix[i, j]:.6g} and "
                    f"({j + 1}, {i + 1}) is {matrix[j, i]:.6g}; give the whole matrix, both halves"
                )
                continue
            if name.startswith("geometric_"):
                continue
            if not size and name != "damping":
                found.append(f"{name}: is zero; give the matrix of the structure")
            elif name != "stiffness" and (row := indefinite_row(matrix)) is not None:
                found.append(
                    f"{name}: is indefinite, found at {self.row_name(row)}; no motion may have "
                    "negative energy: check signs and the elements there"
                )
        return found

    def _wrong_body(self) -> list[str]:
        found = []
        rigid = self.rigid
        masses = np.diag(rigid.T @ (self.mass @ rigid))[:3]
        if masses.max() - masses.min() > _RESISTED * masses.max() or masses.min() <= 0.0:
            words = ", ".join(f"{m:.6g}" for m in masses)
            found.append(
                f"mass: is {words} kg along x, y and z, which must be one number above zero; "
                "is a direction missing, or a unit not kg, m and s?"
            )
        needed = abs(self.stiffness @ rigid).max(axis=0)
        terms = np.asarray((abs(self.stiffness) @ abs(rigid)).max(axis=0))
        held = [k for k in range(6) if needed[k] > _RESISTED * terms[k] > 0.0]
        if held:
            words = ", ".join(DIRECTIONS[k] for k in held)
            found.append(
                f"stiffness: resists rigid motion ({words}); take supports and springs to the "
                "ground out, and give coordinates and matrices in the same units"
            )
        return found

    def row_name(self, row: int) -> str:
        """Return what a row stands for, such as "node 12, rz"."""
        node, direction = self.rows[row]
        return f"node {node}, {DIRECTIONS[direction - 1]}"


def all_rows(numbers: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Return the rows of nodes that have 3 or 6 directions each, node by node.

    Raises
    ------
    InputError
        If the number of rows ``count`` is neither.
    """
    for size in (3, 6):
        if count == size * len(numbers):
            own = [(n, d) for n in numbers for d in range(1, size + 1)]
            return np.array(own, dtype=np.int64)
    raise InputError(
        f"dofs: missing: {count} rows are not 3 or 6 for each of {len(numbers)} nodes; say what "
        "each row stands for: the number of its node and its direction, 1 to 6"
    )


def rigid_motions(places: Array, rows: NDArray[np.int64]) -> Array:
    """Return displacements of rows for unit translations and rotations, shape (n_rows, 6).

    Parameters
    ----------
    places
        Place of the node of each row from the centre of rotation, shape (n_rows, 3) [m].
    rows
        Node and direction of each row.
    """
    found = np.zeros((len(rows), 6))
    found[np.arange(len(rows)), rows[:, 1] - 1] = 1.0
    for axis in range(3):
        moved = np.cross(np.eye(3)[axis], places)
        for direction in range(3):
            own = rows[:, 1] == direction + 1
            found[own, 3 + axis] = moved[own, direction]
    return found


def indefinite_row(matrix: Sparse, floor: float = 1e-10) -> int | None:
    """Return a row at which the factors of a symmetric matrix turn negative, None if none does.

    Parameters
    ----------
    matrix
        The matrix; each row is measured by its diagonal entry.
    floor
        Negative share of the diagonal that passes as rounding.
    """
    diagonal = matrix.diagonal()
    if (diagonal < 0.0).any():
        return int(np.argmin(diagonal))
    loose = np.asarray(abs(matrix).sum(axis=1)).ravel() > 0.0
    if ((diagonal == 0.0) & loose).any():
        return int(np.argmax((diagonal == 0.0) & loose))
    pivots, order = _pivots(matrix, floor)
    return None if (pivots > 0.0).all() else int(order[int(np.argmin(pivots))])


def loose_row(matrix: Sparse, floor: float = 1e-14) -> int | None:
    """Return a row that a semidefinite stiffness leaves free to move, None if there is none.

    Parameters
    ----------
    matrix
        The stiffness; each row is measured by its diagonal entry.
    floor
        Share of the diagonal that is rounding.
    """
    if (matrix.diagonal() <= 0.0).any():
        return int(np.argmin(matrix.diagonal()))
    pivots, order = _pivots(matrix, floor)
    small = int(np.argmin(pivots))
    return int(order[small]) if pivots[small] < 10.0 * floor else None


def _pivots(matrix: Sparse, shift: float) -> tuple[Array, NDArray[np.int64]]:
    """Return pivots of a matrix with unit diagonal and a shift, and the row of each."""
    from scipy.sparse import diags
    from scipy.sparse.linalg import splu

    diagonal = matrix.diagonal()
    empty = diagonal == 0.0
    scale = diags(1.0 / np.sqrt(np.where(empty, 1.0, diagonal)))
    scaled = scale @ matrix @ scale + diags(shift + empty.astype(float))
    try:
        factors = splu(
            scaled.tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError:
        return np.zeros(1), np.zeros(1, dtype=np.int64)
    return factors.U.diagonal(), np.argsort(factors.perm_c)


def _listed(numbers: Sequence[int] | NDArray[np.int64]) -> str:
    words = [str(int(n)) for n in numbers[:_SHOWN]]
    return ", ".join(words) + (
        f" and {len(numbers) - _SHOWN} more" if len(numbers) > _SHOWN else ""
    )
