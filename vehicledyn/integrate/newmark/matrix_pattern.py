"""Which entries the iteration matrix of a model has, and in which order its rows are eliminated.

Both are the same for all parameter sets of a model, so that factors do not depend on the case.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.codegen.printers.implicit_source import colours_of
from vehicledyn.codegen.toolchain import cache
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.symbolic.equations import Equations

Ints = NDArray[np.intc]
Mask = NDArray[np.bool_]

BY_POSITION, BY_VELOCITY, BY_OTHER = range(3)
"""Levers by which an entry of the Jacobian enters the matrix; the numbers are those of record.h."""


@dataclass(frozen=True)
class Triangle:
    """Rows of the entries of a triangular factor by columns, and the same as runs of rows in turn.

    Column j has the entries from ``starts[j]`` on, and the runs from ``run_starts[j]`` on.
    """

    starts: Ints
    rows: Ints
    run_starts: Ints
    run_firsts: Ints
    run_counts: Ints

    @classmethod
    def of(cls, columns: list[NDArray[np.intp]]) -> Triangle:
        """Return the triangle of so many columns with these rows, in order."""
        runs = [
            [run for run in np.split(rows, np.flatnonzero(np.diff(rows) != 1) + 1) if len(run)]
            for rows in columns
        ]
        firsts = _lists([np.array([run[0] for run in own], dtype=np.intp) for own in runs])
        counts = _lists([np.array([len(run) for run in own], dtype=np.intp) for own in runs])
        return cls(*_lists(columns), *firsts, counts[1])


@dataclass(frozen=True)
class MatrixPattern:
    """Entries of the Jacobian of the rates by columns, and those of the factors.

    ``starts`` and ``rows`` are the entries in compressed columns, ``columns`` the state of each;
    ``places`` say where they go in a matrix stored by columns in the order of elimination,
    ``levers`` with which weight. ``below`` and ``above`` are the factors beside their diagonals.
    """

    starts: Ints
    rows: Ints
    columns: Ints
    places: Ints
    levers: Ints
    colour_starts: Ints
    colour_columns: Ints
    order: Ints
    below: Triangle
    above: Triangle


def matrix_pattern(kernel: Kernel) -> MatrixPattern:
    """Return the pattern of a kernel, made once for all its parameter sets."""
    if "matrix pattern" not in kernel.made:
        kernel.made["matrix pattern"] = pattern_of(kernel.equations, _depends_of(kernel))
    found: MatrixPattern = kernel.made["matrix pattern"]
    return found


def _depends_of(kernel: Kernel) -> Mask:
    """Return the same as :func:`rates_by_states`, of compiled kernels from the cache."""
    if not kernel.key:
        return rates_by_states(kernel.equations)
    depends: Mask = cache.load(
        cache.key_of(kernel.key, "rates by states"),
        lambda folder: _written(kernel.equations, folder / "pattern.npy"),
        lambda path: np.load(path, allow_pickle=False),
    )[0]
    return depends


def _written(equations: Equations, path: Path) -> Path:
    np.save(path, rates_by_states(equations))
    return path


def rates_by_states(equations: Equations) -> Mask:
    """Return which states each rate may depend on along closed loops, shape (n, n)."""
    e = equations
    by_state, by_unknown = (_depends(e.rate, column) for column in (e.state, e.algebraic))
    own, others = (_depends(e.residual, column) for column in (e.state, e.algebraic))
    follow = np.zeros_like(own)
    while True:
        found = own | _product(others, follow)
        for block in e.blocks:
            found[block.start : block.stop] = found[block.start : block.stop].any(axis=0)
        if np.array_equal(found, follow):
            break
        follow = found
    return by_state | _product(by_unknown, follow)


def _depends(part: Any, column: Any) -> Mask:
    import casadi

    rows, columns = part.numel(), column.numel()
    found = np.zeros((rows, columns), dtype=bool)
    if rows and columns:
        found[casadi.jacobian_sparsity(part, column).get_triplet()] = True
    return found


def _product(one: Mask, other: Mask) -> Mask:
    found: Mask = one.astype(np.float32) @ other.astype(np.float32) > 0.0
    return found


def pattern_of(equations: Equations, depends: Mask) -> MatrixPattern:
    """Return the pattern of equations whose rates depend on the states so."""
    import casadi

    n_states = len(equations.states)
    positions, velocities = list(equations.positions), list(equations.velocities)
    of_rows = np.setdiff1d(np.arange(n_states), positions)
    n = len(of_rows)
    place, lever = np.zeros(n_states, dtype=np.intc), np.full(n_states, BY_OTHER, dtype=np.intc)
    place[of_rows] = np.arange(n)
    lever[velocities], lever[positions] = BY_VELOCITY, BY_POSITION
    place[positions] = place[velocities]
    columns, rows = np.nonzero(depends[of_rows].T)
    matrix = np.eye(n, dtype=bool)
    matrix[rows, place[columns]] = True
    order, below = eliminated(matrix)
    rank = np.argsort(order)
    sparsity = casadi.Sparsity.triplet(n, n_states, rows.tolist(), columns.tolist())
    colours = np.array(colours_of(sparsity), dtype=int)
    colours[~depends[of_rows].any(axis=0)] = -1
    by_colour = [np.flatnonzero(colours == k) for k in range(colours.max(initial=-1) + 1)]
    return MatrixPattern(
        np.searchsorted(columns, np.arange(n_states + 1)).astype(np.intc),
        rows.astype(np.intc),
        columns.astype(np.intc),
        (rank[rows] + n * rank[place[columns]]).astype(np.intc),
        lever[columns],
        *_lists(by_colour),
        order.astype(np.intc),
        Triangle.of(below),
        Triangle.of(_turned(below)),
    )


def eliminated(matrix: Mask) -> tuple[NDArray[np.intp], list[NDArray[np.intp]]]:
    """Return an order of elimination that fills in little, and the rows below each diagonal.

    Each time the row that is coupled with fewest others goes next (Tinney, Walker (1967), Proc.
    IEEE 55, 1801-1809); rows below are numbered in this order. A pattern that is half full is
    taken for a full one.
    """
    n = len(matrix)
    coupled = matrix | matrix.T
    if 2 * np.count_nonzero(coupled) > n * n:
        coupled[:] = True
    np.fill_diagonal(coupled, False)
    degree, order = coupled.sum(axis=0), []
    below: list[NDArray[np.intp]] = []
    for _ in range(n):
        chosen = int(np.argmin(degree))
        others = np.flatnonzero(coupled[chosen])
        order.append(chosen)
        below.append(others)
        coupled[np.ix_(others, others)] = True
        coupled[chosen], coupled[:, chosen] = False, False
        coupled[others, others] = False
        degree[others] = coupled[others].sum(axis=1)
        degree[chosen] = 2 * n
    found = np.array(order, dtype=np.intp)
    rank = np.argsort(found)
    return found, [np.sort(rank[others]) for others in below]


def _turned(below: list[NDArray[np.intp]]) -> list[NDArray[np.intp]]:
    """Return the rows above each diagonal: factors are as full above as below."""
    filled = np.zeros((len(below), len(below)), dtype=bool)
    for j, rows in enumerate(below):
        filled[j, rows] = True
    return [np.flatnonzero(column) for column in filled.T]


def _lists(items: list[NDArray[np.intp]]) -> tuple[Ints, Ints]:
    """Return where lists of numbers start in one array, and this array."""
    starts = np.cumsum([0, *map(len, items)]).astype(np.intc)
    return starts, np.concatenate([*items, np.zeros(0, dtype=np.intp)]).astype(np.intc)
