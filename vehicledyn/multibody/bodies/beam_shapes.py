"""Assumed shapes of a beam over its length: polynomials that are clamped at the start.

A shape is a polynomial of ξ = x/L in 0 to 1. Of all polynomials of some degree that a clamped
start allows, those are taken that are orthogonal in mass and in stiffness (Rayleigh, Ritz), slowest
first: with no spare degree they span every polynomial of that degree, with many spare ones they
are the eigenfunctions of the clamped beam. Hinged shapes are the sines of a beam whose ends stay on
the first axis.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.weighted_sums import weighted_sum

Array = NDArray[np.float64]

SPARE = 10
"""Spare degree from which shapes are eigenfunctions to eight digits."""


@dataclass(frozen=True, eq=False)
class TruncatedPowers:
    """Truncated powers (ξ - a)₊ᵖ that shapes have beside their polynomials.

    ``places`` are the a, shape (n,), ``power`` is p, ``shares`` the part of each power in each
    shape, shape (n, count).
    """

    places: Array
    power: int
    shares: Array

    def at(self, places: Array, derivative: int = 0) -> Array:
        """Return the part of the shapes, or its derivative; at a jump the mean of both sides."""
        beyond = places[:, None] - self.places
        left = self.power - derivative
        if left < 0:
            return np.zeros((len(places), self.shares.shape[1]))
        factor = math.factorial(self.power) / math.factorial(left)
        powers = np.heaviside(beyond, 0.5) if left == 0 else np.maximum(beyond, 0.0) ** left
        return np.asarray(factor * powers @ self.shares)


@dataclass(frozen=True, eq=False)
class Shapes:
    """Shapes φ_k(ξ) with ∫ φ_i φ_j dξ = δ_ij and ∫ φ_i⁽ᵐ⁾ φ_j⁽ᵐ⁾ dξ = λ_k δ_ij.

    ``coefficients`` are those of Legendre polynomials of 2 ξ - 1, a column a shape; ``stiffness``
    are the λ_k; m is 2 for bending and 1 for twist and stretch. ``points`` of a Gauss
    quadrature integrate products of two shapes and the place; ``slopes`` is at how many places
    the squared slope of a combination is taken, ``points`` less one if None; ``kinks`` are what
    they have beside the polynomials, and then ``points`` is that of each part between the kinks.
    """

    coefficients: Array
    stiffness: Array
    points: int
    slopes: int | None = None
    kinks: TruncatedPowers | None = None

    @property
    def count(self) -> int:
        """Number of shapes."""
        return int(self.coefficients.shape[1])

    @property
    def degree(self) -> int:
        """Degree of the polynomials."""
        return len(self.coefficients) - 1 if self.count else 0

    def values(self, place: float, derivative: int = 0) -> Array:
        """Return φ_k or a derivative by ξ at a place, shape (count,)."""
        return np.asarray(self.at(np.array([place]), derivative)[0])

    def at(self, places: Array, derivative: int = 0) -> Array:
        """Return φ_k or a derivative by ξ at places of shape (n,), shape (n, count)."""
        if not self.count:
            return np.zeros((len(places), 0))
        turned = legendre.legder(self.coefficients, derivative, scl=2.0)
        found: Array = np.asarray(legendre.legval(2.0 * places - 1.0, turned).T)
        if self.kinks is not None:
            found = found + self.kinks.at(places, derivative)
        return found

    @property
    def breaks(self) -> tuple[float, ...]:
        """Places at which polynomials meet, ascending."""
        return () if self.kinks is None else tuple(map(float, self.kinks.places))

    def mixed(self, turn: Array) -> Shapes:
        """Return combinations of the shapes, a column of ``turn`` each."""
        own = self.kinks
        kinks = None if own is None else replace(own, shares=own.shares @ turn)
        return replace(self, coefficients=self.coefficients @ turn, kinks=kinks)

    def anywhere(self, place: Scalar) -> list[Scalar]:
        """Return φ_k at a place that is an expression, by Clenshaw's recursion."""
        x = 2.0 * place - 1.0
        found: list[Scalar] = []
        for column in self.coefficients.T:
            before, last = ops.scalar(0.0), ops.scalar(0.0)
            for n in range(len(column) - 1, -1, -1):
                factor = (2.0 * n + 1.0) / (n + 1.0)
                now = factor * x * last - (n + 1.0) / (n + 2.0) * before + float(column[n])
                before, last = last, now
            found.append(last)
        if self.kinks is None:
            return found
        powers = [ops.maximum(place - a, 0.0) ** self.kinks.power for a in self.breaks]
        return [
            value + weighted_sum(row, powers)
            for value, row in zip(found, self.kinks.shares.T, strict=True)
        ]

    def shortening(self, place: float) -> Array:
        """Return ∫ φ_i' φ_j' dξ from 0 to a place, shape (count, count)."""
        within = tuple(a / place for a in self.breaks if a < place)
        points, weights = quadrature(self.degree + 1, within)
        slopes = self.at(place * points, 1)
        return np.asarray(place * (slopes.T * weights) @ slopes)


@lru_cache(maxsize=64)
def quadrature(count: int, breaks: tuple[float, ...] = ()) -> tuple[Array, Array]:
    """Return places from 0 to 1 and weights of a Gauss quadrature, shape (count,) each.

    With ``breaks`` in between it has as many points in each part.
    """
    places, weights = np.polynomial.legendre.leggauss(count)
    edges = np.array([0.0, *breaks, 1.0])
    spans = np.diff(edges)
    return (
        (edges[:-1, None] + spans[:, None] * (0.5 * (1.0 + places))).ravel(),
        (spans[:, None] * (0.5 * weights)).ravel(),
    )


def points_of_a_part(points: int, kinks: int) -> int:
    """Return how many points each part between kinks needs where the whole would need some."""
    return -(-points // (kinks + 1)) + 2 if kinks else points


@lru_cache(maxsize=64)
def assumed_shapes(count: int, order: int, spare: int = 0) -> Shapes:
    """Return the first shapes of a beam that is clamped at ξ = 0.

    Parameters
    ----------
    count
        Number of shapes.
    order
        Order of the derivative whose square is the strain energy: 2 for bending, 1 for twist and
        stretch.
    spare
        Polynomials beyond ``count`` to compose them of.
    """
    size = count + spare
    if not count:
        return Shapes(np.zeros((1, 0)), np.zeros(0), 0)
    chosen, stiffness = _decoupled(clamped_polynomials(size, order), order)
    return Shapes(chosen[:, :count], stiffness[:count], size + order)


def clamped_polynomials(count: int, order: int) -> Array:
    """Return ξ to the power ``order`` times the first Legendre polynomials, a column each."""
    basis = np.eye(count)
    for _ in range(order):
        basis = _times_place(basis)
    return basis


def _decoupled(basis: Array, order: int) -> tuple[Array, Array]:
    """Return combinations that mass and stiffness do not couple, and their stiffness, ascending."""
    points, weights = quadrature(len(basis) + 1)
    parts = Shapes(basis, np.zeros(basis.shape[1]), 0)
    moved, bent = parts.at(points), parts.at(points, order)
    mass, stiff = ((item.T * weights) @ item for item in (moved, bent))
    root = np.linalg.inv(np.linalg.cholesky(mass))
    found, vectors = np.linalg.eigh(root @ stiff @ root.T)
    chosen = basis @ (root.T @ vectors)
    return chosen * np.sign(legendre.legval(1.0, chosen)), found


@lru_cache(maxsize=16)
def hinged_shapes(count: int) -> Shapes:
    """Return √2 sin k π ξ, the bending shapes of a beam with a hinge at each end."""
    if not count:
        return assumed_shapes(0, 2)
    degree = 4 * count + 14
    points, weights = quadrature(degree + 8)
    order = np.arange(degree + 1)
    sines = np.sqrt(2.0) * np.sin(np.pi * np.outer(points, np.arange(1, count + 1)))
    basis = legendre.legvander(2.0 * points - 1.0, degree)
    coefficients = (2.0 * order + 1.0)[:, None] * ((basis.T * weights) @ sines)
    stiffness = np.asarray((np.pi * np.arange(1.0, count + 1.0)) ** 4, dtype=np.float64)
    return Shapes(coefficients, stiffness, 2 * count + 6)


@lru_cache(maxsize=16)
def free_shapes(count: int) -> Shapes:
    """Return bending shapes clamped at ξ = 0 of a beam whose body is free to move and turn.

    Half of them, at most four, span the polynomials ξ², ξ³ ..., deflections under end forces and
    even loads; the others the eigenfunctions of the beam with free ends less their rigid motion at
    ξ = 0. With the motion of the body they span these eigenfunctions.
    """
    if not count:
        return assumed_shapes(0, 2)
    plain = min(_PLAIN, count - count // 2)
    degree = 4 * count + 18
    places, weights = quadrature(degree + 8)
    order = np.arange(degree + 1)
    fit = (2.0 * order + 1.0)[:, None] * legendre.legvander(2.0 * places - 1.0, degree).T * weights
    waves = [fit @ (_with_free_ends(k, places) / places**2) for k in range(count - plain)]
    columns = np.array([*np.eye(plain, degree + 1), *waves]).T
    return Shapes(*_decoupled(_times_place(_times_place(columns)), 2), 2 * count + 6, count + 2)


_PLAIN = 4
"""Most polynomials among the shapes of a free beam."""
_ROOTS = (4.730040744862704, 7.853204624095838, 10.995607838001671)
"""Roots of cos b cosh b = 1; the next are odd multiples of π/2 to rounding."""


def _with_free_ends(number: int, places: Array) -> Array:
    """Return an eigenfunction of the free beam less its place and slope at ξ = 0."""
    b = _ROOTS[number] if number < len(_ROOTS) else (number + 1.5) * np.pi
    # cosh - s sinh = exp(-) - (s - 1) sinh, which does not cancel.
    excess = (np.exp(-b) - np.cos(b) + np.sin(b)) / (np.sinh(b) - np.sin(b))
    x, s = b * places, 1.0 + excess
    waves = np.exp(-x) - excess * np.sinh(x) + np.cos(x) - s * np.sin(x)
    return np.asarray(waves - 2.0 + 2.0 * s * x)


def _times_place(columns: Array) -> Array:
    """Return the coefficients of polynomials times ξ = (1 + (2 ξ - 1)) / 2, column by column."""
    made = [0.5 * legendre.legadd(c, legendre.legmulx(c)) for c in columns.T]
    return np.array([np.pad(c, (0, len(columns) + 1 - len(c))) for c in made]).T
