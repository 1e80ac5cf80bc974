"""Objective and constraints of a nonlinear program: linear in its variables and in point functions.

Row 0 is the objective, the others are constraints. A point function is evaluated at many points,
of variables that are some of the program's; each of its outputs enters at most one row.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.optimal_control.point_derivatives import PointDerivatives

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]

OBJECTIVE = 0
"""The row of the objective."""


class PointGroup:
    """A function at points.

    Parameters
    ----------
    function
        With its derivatives.
    variables
        Which of the program's variables are those of each point, (n_points, n_variables).
    constants
        Numbers of the points, shape (n_points, n_constants).
    """

    def __init__(self, function: PointDerivatives, variables: Indices, constants: Floats) -> None:
        self.function, self.variables, self.constants = function, variables, constants
        shape = len(variables), function.n_outputs
        self.row = np.full(shape, -1, dtype=np.int64)
        self.weight = np.zeros(shape)

    def send(self, points: Indices, outputs: Indices, rows: Indices, weights: Any) -> None:
        """Add outputs at points to rows, both of shape (n_points, n_outputs), times weights."""
        if outputs.size:
            place = np.ix_(points, outputs)
            self.row[place], self.weight[place] = rows, weights


@dataclass(frozen=True)
class Matrix:
    """The pattern of a sparse matrix by columns, and where entries are added.

    ``rows`` and ``starts`` as in compressed columns; ``fixed`` the sum of what does not change;
    ``target`` and ``factor`` of those that do, which are ``source`` among what is given.
    """

    rows: Indices
    starts: Indices
    fixed: Floats
    source: Indices
    target: Indices
    factor: Floats

    def filled(self, entries: Floats) -> Floats:
        """Return the numbers of the matrix."""
        moving = self.factor * entries[self.source]
        added = np.bincount(self.target, moving, minlength=self.fixed.size)
        return np.asarray(self.fixed + added)


@dataclass
class BoundedRows:
    """Rows with their bounds, for variables that are divided by their ``scale``."""

    scale: Floats
    groups: list[PointGroup] = field(default_factory=list)
    count: int = 1
    _low: list[Floats] = field(default_factory=list)
    _high: list[Floats] = field(default_factory=list)
    _linear: list[tuple[Indices, Indices, Floats]] = field(default_factory=list)

    def bounded(self, low: Floats, high: Floats) -> Indices:
        """Return new rows with bounds."""
        self._low.append(np.asarray(low, dtype=float))
        self._high.append(np.asarray(high, dtype=float))
        found = np.arange(self.count, self.count + len(low))
        self.count += len(low)
        return found

    def equations(self, count: int) -> Indices:
        """Return new rows that are zero."""
        return self.bounded(np.zeros(count), np.zeros(count))

    def add(self, rows: Indices, columns: Indices, factors: Any) -> None:
        """Add variables times factors to rows."""
        parts = np.broadcast_arrays(rows, columns, np.asarray(factors, dtype=float))
        self._linear.append((parts[0].ravel(), parts[1].ravel(), parts[2].ravel()))

    @property
    def bounds(self) -> tuple[Floats, Floats]:
        """Bounds of the constraints."""
        return np.concatenate([*self._low, np.zeros(0)]), np.concatenate([*self._high, np.zeros(0)])

    def finish(self) -> None:
        """Find the patterns of the derivatives, after all rows are there."""
        nothing = np.zeros(0, dtype=np.int64)
        linear = [np.concatenate(part) for part in zip(*self._linear, strict=True)]
        self._of_linear = linear if linear else [nothing, nothing, np.zeros(0)]
        rows, columns, factors = self._of_linear
        fixed = rows, columns, factors * self.scale[columns]
        entries = [self._first_order(group) for group in self.groups]
        parts = [np.concatenate(part) for part in zip(*entries, strict=True)]
        self.slopes = _matrix(fixed, parts, self.count, self.scale.size)
        bends = [self._second_order(group) for group in self.groups]
        parts = [np.concatenate(part) for part in zip(*bends, strict=True)]
        self.bends = _matrix((nothing, nothing, np.zeros(0)), parts, *2 * (self.scale.size,))

    def _first_order(self, group: PointGroup) -> tuple[Indices, Indices, Floats]:
        outputs, variables = group.function.jacobian_entries
        row, column = group.row[:, outputs], group.variables[:, variables]
        factor = group.weight[:, outputs] * self.scale[column]
        return row.ravel(), column.ravel(), factor.ravel()

    def _second_order(self, group: PointGroup) -> tuple[Indices, Indices, Floats]:
        """Return entries of the upper triangle."""
        first, second = (group.variables[:, k] for k in group.function.hessian_entries)
        factor = self.scale[first] * self.scale[second]
        return np.minimum(first, second).ravel(), np.maximum(first, second).ravel(), factor.ravel()

    def values(self, variables: Floats) -> Floats:
        """Return the rows at variables that are divided by their scales."""
        true = variables * self.scale
        rows, columns, factors = self._of_linear
        total = np.bincount(rows, factors * true[columns], minlength=self.count)
        for group in self.groups:
            found = group.function.values(true[group.variables], group.constants)
            used = group.row >= 0
            total += np.bincount(
                group.row[used], (group.weight * found)[used], minlength=self.count
            )
        return np.asarray(total)

    def jacobian(self, variables: Floats) -> Floats:
        """Return the derivatives of all rows, the numbers of ``slopes``."""
        true = variables * self.scale
        found = [g.function.jacobian(true[g.variables], g.constants).ravel() for g in self.groups]
        return self.slopes.filled(np.concatenate(found))

    def hessian(self, variables: Floats, multipliers: Floats) -> Floats:
        """Return second derivatives of the rows times multipliers, the numbers of ``bends``."""
        true, found = variables * self.scale, []
        for group in self.groups:
            weights = np.where(group.row >= 0, group.weight * multipliers[group.row], 0.0)
            entries = group.function.hessian(true[group.variables], group.constants, weights)
            found.append(entries.ravel())
        return self.bends.filled(np.concatenate(found))


def _matrix(fixed: Any, moving: Any, n_rows: int, n_columns: int) -> Matrix:
    """Return the matrix of entries (rows, columns, factors), fixed ones and others.

    Others whose row is below zero are left out.
    """
    (source,) = np.nonzero(moving[0] >= 0)
    moving = [part[source] for part in moving]
    keys = [columns * n_rows + rows for rows, columns, _ in (fixed, moving)]
    known, target = np.unique(np.concatenate(keys), return_inverse=True)
    n_fixed, rows, columns = len(keys[0]), known % n_rows, known // n_rows
    base = np.asarray(np.bincount(target[:n_fixed], fixed[2], minlength=known.size), dtype=float)
    starts = np.searchsorted(columns, np.arange(n_columns + 1))
    return Matrix(rows, starts, base, source, target[n_fixed:], moving[2])
