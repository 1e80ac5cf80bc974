"""Polynomial chaos: figures as polynomials of uncertain parameters, with their Sobol indices.

Xiu, Karniadakis (2002), SIAM Journal on Scientific Computing 24, 619-644, for the expansion;
Sudret (2008), Reliability Engineering and System Safety 93, 964-979, for the indices; Blatman,
Sudret (2010), Probabilistic Engineering Mechanics 25, 183-197, for the choice by leaving one out;
the covariance of coefficients is that of least squares, errors are theirs by the delta method.
The nodes of quadratures are NumPy's.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.uncertainty import Distribution, Shares, Spread

Floats = NDArray[np.float64]

_HIGHEST = 20
"""Degree of the polynomials at most."""

_MOST_TERMS = 2000

_RUNS_PER_TERM = 1.5
"""Runs a term of an expansion needs at least."""


@dataclass(frozen=True)
class Chaos:
    """An expansion of figures (m,) in orthonormal polynomials of n parameters.

    ``powers`` (t, n) are the degrees of each term, the first of them the constant,
    ``coefficients`` (t, m). ``missed`` (m,) is the part of the variance that the expansion misses
    at points it was not fitted to, from leaving out one by one, ``misses`` (m,) the variance of
    that; ``covariance`` (t, t) is that of the coefficients, by ``misses``.
    """

    laws: tuple[Distribution, ...]
    powers: NDArray[np.int64]
    coefficients: Floats
    missed: Floats
    misses: Floats
    covariance: Floats

    @property
    def degree(self) -> int:
        """Highest degree of a term."""
        return int(self.powers.sum(axis=1).max(initial=0))

    def values(self, points: Floats) -> Floats:
        """Return the figures at some points (k, n), shape (k, m)."""
        return np.asarray(basis(self.laws, points, self.powers) @ self.coefficients)

    @property
    def spread(self) -> Spread:
        """Mean and deviation; their errors are those of the coefficients and of what is missed."""
        variance = np.sum(self.coefficients[1:] ** 2, axis=0)
        deviation = np.sqrt(variance)
        slopes = 2.0 * self.coefficients.T
        slopes[:, 0] = 0.0
        own = self._errors(slopes)
        own = np.divide(own, 2.0 * deviation, out=np.zeros_like(own), where=deviation > 0.0)
        error = np.hypot(own, np.sqrt(variance + self.misses) - deviation)
        mean_error = np.sqrt(self.misses * self.covariance[0, 0])
        return Spread(self.coefficients[0], deviation, mean_error, error)

    def shares(self) -> Shares:
        """Return first-order and total Sobol indices; what is missed may belong to any."""
        parts = self.coefficients.T**2
        parts[:, 0] = 0.0
        whole = parts.sum(axis=1, keepdims=True)
        within = self.powers > 0
        alone = within & (within.sum(axis=1) == 1)[:, None]
        missed = np.divide(
            self.misses[:, None],
            whole + self.misses[:, None],
            out=np.zeros_like(whole),
            where=self.misses[:, None] > 0.0,
        )

        def share(chosen: NDArray[np.bool_]) -> tuple[Floats, Floats]:
            """Return the part of chosen terms (t, n) in the variance and its error, (m, n)."""
            rows = chosen.astype(float)
            known = whole > 0.0
            found = np.divide(
                parts @ rows, whole, out=np.zeros((len(parts), rows.shape[1])), where=known
            )
            errors = np.zeros_like(found)
            for k, row in enumerate(rows.T):
                slopes = 2.0 * self.coefficients.T * (row - found[:, k : k + 1])
                slopes[:, 0] = 0.0
                own = self._errors(slopes)
                np.divide(own, whole[:, 0], out=errors[:, k], where=known[:, 0])
            return found, np.hypot(errors, missed * np.maximum(found, 1.0 - found))

        (first, first_error), (total, total_error) = share(alone), share(within)
        return Shares(first, total, first_error, total_error)

    def _errors(self, slopes: Floats) -> Floats:
        """Return the standard errors of what has slopes (m, t) by the coefficients, shape (m,)."""
        squares = np.einsum("mt,ts,ms->m", slopes, self.covariance, slopes)
        errors: Floats = np.sqrt(np.maximum(squares * self.misses, 0.0))
        return errors


def fit_chaos(laws: Sequence[Distribution], points: Floats, figures: Floats) -> Chaos:
    """Return the expansion that foretells left-out runs best, among those of growing degree.

    Parameters
    ----------
    laws
        Independent distributions of the n parameters.
    points
        Where the figures are known, shape (number, n).
    figures
        Shape (number, m).
    """
    best: Chaos | None = None
    scatter = np.var(figures, axis=0)
    sizes = np.where(scatter > 0.0, scatter, 1.0)
    for powers in _truncations(len(laws), len(points)):
        values = basis(laws, points, powers)
        left, triangle = np.linalg.qr(values)
        sizes_kept = np.abs(np.diag(triangle))
        if sizes_kept.min() <= 1e-10 * sizes_kept.max():
            break
        coefficients = np.linalg.solve(triangle, left.T @ figures)
        leverage = np.sum(left**2, axis=1)
        if leverage.max() >= 1.0 - 1e-9:
            break
        foretold = (figures - values @ coefficients) / (1.0 - leverage)[:, None]
        missed = np.mean(foretold**2, axis=0) / sizes
        inverse = np.linalg.inv(triangle)
        missed = np.where(scatter > 0.0, missed, 0.0)
        misses = missed * scatter
        found = Chaos(tuple(laws), powers, coefficients, missed, misses, inverse @ inverse.T)
        if best is None or found.missed.max() < best.missed.max():
            best = found
    assert best is not None  # a constant fits two points
    return best


def basis(laws: Sequence[Distribution], points: Floats, powers: NDArray[np.int64]) -> Floats:
    """Return the products of orthonormal polynomials at points (k, n), shape (k, t)."""
    highest = int(powers.max(initial=0))
    found = np.ones((len(points), len(powers)))
    for k, law in enumerate(laws):
        found *= orthonormal(law, points[:, k], highest)[:, powers[:, k]]
    return found


def orthonormal(law: Distribution, x: Floats, highest: int) -> Floats:
    """Return the polynomials of degree 0 to highest at x, orthonormal under a law.

    Shape (len(x), highest + 1).
    """
    centres, lengths = _recurrence(law, highest)
    table, place = np.ones((highest + 1, len(x))), (x - law.mean) / law.deviation
    for k in range(highest):
        row = (place - centres[k]) * table[k]
        if k:
            row -= lengths[k - 1] * table[k - 1]
        table[k + 1] = row / lengths[k]
    return table.T


def gauss_rule(law: Distribution, number: int) -> tuple[Floats, Floats]:
    """Return nodes and weights, each (number,), of the Gauss quadrature under a law.

    Golub, Welsch (1969), Mathematics of Computation 23, 221-230.
    """
    centres, lengths = _recurrence(law, number)
    between = lengths[: number - 1]
    matrix = np.diag(centres[:number]) + np.diag(between, 1) + np.diag(between, -1)
    places, vectors = np.linalg.eigh(matrix)
    return law.mean + law.deviation * places, vectors[0] ** 2


def _recurrence(law: Distribution, highest: int) -> tuple[Floats, Floats]:
    """Return a and b of b[k] p[k + 1] = (x - a[k]) p[k] - b[k - 1] p[k - 1], shapes (highest,).

    x is measured from the mean in deviations. Stieltjes' procedure on a quadrature that is exact
    for all products in question: Gautschi (2004), Orthogonal Polynomials, section 2.2.
    """
    nodes, weights = law.quadrature(2 * highest + 2)
    nodes = (nodes - law.mean) / law.deviation
    centres, lengths = np.zeros(highest), np.zeros(highest)
    before, here = np.zeros(len(nodes)), np.ones(len(nodes))
    for k in range(highest):
        centres[k] = weights @ (nodes * here**2)
        row = (nodes - centres[k]) * here - (lengths[k - 1] if k else 0.0) * before
        lengths[k] = np.sqrt(weights @ row**2)
        before, here = here, row / lengths[k]
    return centres, lengths


def _truncations(n: int, number: int) -> list[NDArray[np.int64]]:
    """Return the terms of growing expansions: all of a total degree, and those with few mixed.

    The latter keep the q-norm of the degrees, q = 0.75, below the highest one.
    """
    most = min(int(number / _RUNS_PER_TERM), _MOST_TERMS)
    found: list[NDArray[np.int64]] = [np.zeros((1, n), dtype=np.int64)]
    for q in (1.0, 0.75):
        for degree in range(1, _HIGHEST + 1):
            powers = _powers(n, degree, q, most)
            if powers is None:
                break
            found.append(powers)
    return found


def _powers(n: int, degree: int, q: float, most: int) -> NDArray[np.int64] | None:
    """Return the degrees of all terms, None if they are more than can be fitted."""
    rows: list[tuple[int, ...]] = [()]
    for _ in range(n):
        rows = [
            (*row, power)
            for row, power in itertools.product(rows, range(degree + 1))
            if sum(p**q for p in (*row, power)) <= degree**q * (1.0 + 1e-12)
        ]
        if len(rows) > most:
            return None
    return np.array(sorted(rows, key=lambda row: (sum(row), row)), dtype=np.int64)
