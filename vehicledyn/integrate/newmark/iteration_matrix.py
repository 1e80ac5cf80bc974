"""The scaled iteration matrix of a step on residuals with multipliers, sparsely factorised."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.newmark.residual_functions import Partials, Sparse
from vehicledyn.integrate.newmark.weights import Weights
from vehicledyn.kernel.engine import Vector


class Unknowns(NamedTuple):
    """The unknowns of a step, or changes of them: accelerations, rates, multipliers and η."""

    a: Vector
    r: Vector
    multiplier: Vector
    eta: Vector


@dataclass(frozen=True)
class StepFactors:
    """Factors of the matrix for steps of one size [s], and the Jacobian they came from.

    ``scales`` are the weight of the masses, the mass that makes multipliers and masses of the same
    size, and what does so for η; ``cuts`` are where kinds of unknowns end.
    """

    partials: Partials
    size: float
    matrix: Any
    factors: Any
    scales: tuple[float, float, float]
    cuts: tuple[int, int, int]

    def is_for(self, size: float) -> bool:
        """Return whether the factors are those of a step size, but for rounding."""
        return abs(size - self.size) <= 1e-9 * self.size

    def solve(self, residual: Vector) -> Unknowns:
        """Return the changes that remove a residual of the linearised step."""
        first, second, third = self.cuts
        lead, scale, lever = self.scales
        right = residual.copy()
        right[:first] /= lead
        right[second:] *= scale
        found = self.factors.solve(right) if len(right) else right
        a, r, multiplier, eta = np.split(found, [first, second, third])
        return Unknowns(a, r, multiplier * scale * lead, eta * lever)

    def condition(self) -> float:
        """Return the condition of the scaled matrix in the 2-norm."""
        return float(np.linalg.cond(self.matrix.toarray()))


@dataclass(frozen=True)
class _Layout:
    """Where the elements of the parts of a matrix stand in its compressed columns.

    ``place`` numbers the kept elements; ``rows`` and ``starts`` are those of compressed columns.
    """

    place: NDArray[np.intp]
    rows: NDArray[np.intp]
    starts: NDArray[np.intp]
    size: int

    @classmethod
    def of(cls, p: Partials, sizes: tuple[int, int, int]) -> _Layout:
        """Return the layout of forces, further states and gaps by a, r and multipliers."""
        n, k, m = sizes
        own = np.arange(n, n + k)
        constraint = p.jacobian.rows + n + k, p.jacobian.columns
        parts = [
            *((x.rows, x.columns) for x in (p.f_a, p.f_v, p.f_q)),
            (p.f_s.rows, p.f_s.columns + n),
            *((x.rows + n, x.columns) for x in (p.s_v, p.s_q)),
            (p.s_s.rows + n, p.s_s.columns + n),
            (own, own),
            constraint[::-1],
            constraint,
        ]
        size = n + k + m
        keys = np.concatenate([columns * size + rows for rows, columns in parts])
        kept, place = np.unique(keys, return_inverse=True)
        columns, rows = np.divmod(kept, max(size, 1))
        return cls(place, rows, np.searchsorted(columns, np.arange(size + 1)), size)

    def matrix(self, values: list[Vector]) -> Any:
        """Return the matrix whose parts have these values, in the order of :meth:`of`."""
        from scipy.sparse import csc_matrix

        data = np.bincount(self.place, np.concatenate(values), len(self.rows))
        return csc_matrix((data, self.rows, self.starts), shape=(self.size, self.size))


class IterationMatrix:
    """Puts the parts of the Jacobian where they belong and factorises the whole."""

    def __init__(self, sizes: tuple[int, int, int], lightness: Vector | None = None) -> None:
        """Take the numbers of coordinates, further states and multipliers, and W where η is."""
        self._sizes, self._lightness = sizes, lightness
        self._layout: _Layout | None = None

    def factorised(
        self, partials: Partials, weights: Weights, h: float, mean: Sparse | None
    ) -> StepFactors:
        """Return the factors of the matrix of a step of size h [s].

        ``mean`` is the Jacobian of the constraints along which η moves the coordinates.

        Rows are those of forces, further states, gaps and openings; columns those of accelerations,
        rates, multipliers and η.

        Raises
        ------
        NumericalError
            If the matrix is singular, as constraints depend on each other.
        """
        w, p = weights, partials
        n, k, m = self._sizes
        scale = _typical(p.f_a, n)
        by_a, by_r, bend = h * w.gamma, h * w.first_order_gamma, h**2 * w.beta
        part = 1.0 - w.alpha_f
        lead = (1.0 - w.alpha_m) / part
        if self._layout is None:
            self._layout = _Layout.of(p, self._sizes)
        matrix = self._layout.matrix(
            [
                p.f_a.values,
                (by_a / lead) * p.f_v.values,
                (bend / lead) * p.f_q.values,
                (by_r / lead) * p.f_s.values,
                -part * by_a * p.s_v.values,
                -part * bend * p.s_q.values,
                -part * by_r * p.s_s.values,
                np.full(k, w.first_order_mass),
                scale * p.jacobian.values,
                scale * p.jacobian.values,
            ]
        )
        lever = w.beta * h * scale
        if self._lightness is not None and mean is not None:
            arms = lever * arms_of(mean, self._lightness)
            matrix = self._stabilised(matrix, p, w, (h, scale, lead), arms).tocsc()
        cuts = n, n + k, n + k + m
        return StepFactors(p, h, matrix, _factors(matrix), (lead, scale, lever), cuts)

    def _stabilised(
        self,
        matrix: Any,
        p: Partials,
        w: Weights,
        numbers: tuple[float, float, float],
        arms: Any,
    ) -> Any:
        """Return the matrix with the rows of the openings and the columns of η."""
        from scipy.sparse import csc_matrix, hstack, vstack

        h, scale, lead = numbers
        _, k, m = self._sizes
        opening = p.h_q.matrix()
        by_a = p.jacobian.matrix() + (w.beta * h / w.gamma) * opening
        row = hstack([scale * by_a, csc_matrix((m, k + m))])
        part = 1.0 - w.alpha_f
        column = vstack(
            [
                -h / lead * (p.f_q.matrix() @ arms),
                part * h * (p.s_q.matrix() @ arms),
                -scale / (w.beta * h) * (p.jacobian.matrix() @ arms),
                -scale / w.gamma * (opening @ arms),
            ]
        )
        return hstack([vstack([matrix, row]), column])

    def accelerations(
        self, partials: Partials, force: Vector, quadratic: Vector
    ) -> tuple[Vector, Vector]:
        """Return q̈ and λ of a state: M q̈ + Jᵀ λ = -F, J q̈ = -γ, F being the force at rest.

        Raises
        ------
        NumericalError
            If constraints depend on each other there, or a coordinate moves no mass.
        """
        from scipy.sparse import csc_matrix, hstack, vstack

        n, _, m = self._sizes
        scale = _typical(partials.f_a, n)
        constraint = scale * partials.jacobian.matrix()
        matrix = vstack(
            [
                hstack([partials.f_a.matrix(), constraint.T]),
                hstack([constraint, csc_matrix((m, m))]),
            ]
        ).tocsc()
        found = _factors(matrix).solve(-np.concatenate([force, scale * quadratic]))
        return found[:n], found[n:] * scale


def arms_of(jacobian: Sparse, lightness: Vector) -> Any:
    """Return W Jᵀ, shape (n, m): how η moves the coordinates."""
    from scipy.sparse import csr_matrix

    values = jacobian.values * lightness[jacobian.columns]
    return csr_matrix((values, (jacobian.columns, jacobian.rows)), shape=jacobian.shape[::-1])


def pushed(jacobian: Sparse, lightness: Vector, eta: Vector) -> Vector:
    """Return W Jᵀ η, how fast η moves the coordinates."""
    rows, columns = jacobian.rows, jacobian.columns
    moved = np.bincount(columns, jacobian.values * eta[rows], len(lightness))
    found: Vector = lightness * moved
    return found


class _Nothing:
    """Stands for the factors of a matrix without rows."""

    def solve(self, right: Vector) -> Vector:
        return right


def _factors(matrix: Any) -> Any:
    from scipy.sparse.linalg import splu

    if not matrix.shape[0]:
        return _Nothing()
    try:
        return splu(matrix)
    except RuntimeError:
        raise NumericalError(
            "the iteration matrix is singular; constraints depend on each other, or a coordinate "
            "moves no mass"
        ) from None


def _typical(mass: Sparse, n: int) -> float:
    """Return the geometric mean of the masses on the diagonal, one where there are none."""
    diagonal = mass.values[mass.rows == mass.columns] if n else np.zeros(0)
    known = diagonal[diagonal > 0.0]
    return float(np.exp(np.log(known).mean())) if len(known) else 1.0
