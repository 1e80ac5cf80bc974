"""Newton's method for a periodic orbit: collocation, condensed to the mesh points.

    x' = T f(x, p),  x(0) = x(1),  ∫ x_ref'·(x - x_ref) dτ = 0  and one further condition

The inner points of every interval are eliminated, all intervals at once; what remains couples
neighbouring mesh points, period, parameter and two rows, and is factorised as a sparse matrix.

References
----------
Doedel, Keller, Kernévez (1991), Numerical analysis and control of bifurcation problems,
Int. J. Bifurcation and Chaos 1(3) and 1(4).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from vehicledyn.analyse.periodic.autonomous import AutonomousField, Field
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.engine import Vector

MOST_ITERATIONS = 12
BORDER = 1e-6
"""Factor on the two rows of the orbit's conditions while they are factorised."""

CONVERGED = 1e-9
"""Correction, part of the scales, below which an orbit is found."""


@dataclass(frozen=True)
class Direction:
    """A change of an orbit: states like those of the orbit, period and parameter."""

    states: Vector
    period: float
    parameter: float

    def times(self, factor: float) -> Direction:
        """Return a multiple."""
        return Direction(self.states * factor, self.period * factor, self.parameter * factor)


@dataclass(frozen=True)
class Scales:
    """Sizes of states, period and parameter, with which changes are measured."""

    states: Vector
    period: float
    parameter: float


@dataclass(frozen=True)
class Factors:
    """Factors of a Newton matrix whose last two rows are made small by ``small``."""

    factors: Any
    small: float

    def solve(self, right: Vector) -> Vector:
        """Return the solution for a right side (n,), or for several (n, n_columns)."""
        scaled = np.array(right, dtype=float)
        scaled[-2:] *= self.small
        return np.asarray(self.factors.solve(scaled))


@dataclass(frozen=True)
class Condensed:
    """The linear system of one Newton step, on which directions and multipliers rest."""

    orbit: Orbit
    scales: Scales
    solved: Vector
    follow: Field
    phase: Vector

    @property
    def size(self) -> int:
        """Number of states."""
        return int(self.orbit.states.shape[1])

    @cached_property
    def _parts(self) -> tuple[Any, Any]:
        """Row and column indices of the blocks that couple neighbouring mesh points."""
        n, count = self.size, self.orbit.intervals
        block = np.arange(count)[:, None, None] * n
        rows = np.broadcast_to(block + np.arange(n)[:, None], (count, n, n))
        columns = np.broadcast_to(block + np.arange(n), (count, n, n))
        return rows, columns

    def factorised(self, last: tuple[Vector, float, float]) -> Factors:
        """Return the factors of the matrix with a last row (states, period, parameter).

        The two full rows are made small, so that pivots are taken from them last: taken early,
        they would fill the factors, whose cost would grow with the square of the intervals.
        """
        from scipy.sparse import csc_matrix
        from scipy.sparse.linalg import splu

        n, count = self.size, self.orbit.intervals
        total = n * count
        rows, columns = self._parts
        own = np.arange(total)
        ahead = (own + n) % total
        column = self.solved[:, -n:, n : n + 2].reshape(total, 2)
        border = np.zeros((2, total + 2))
        for k, (row, by_period, by_parameter) in enumerate(((self.phase, 0.0, 0.0), last)):
            border[k, :total], border[k, total:] = self._condense(row, by_period, by_parameter)
        parts = [
            (rows.ravel(), columns.ravel(), self.solved[:, -n:, :n].ravel()),
            (own, ahead, np.ones(total)),
            (own, np.full(total, total), column[:, 0]),
            (own, np.full(total, total + 1), column[:, 1]),
            (np.full(total + 2, total), np.arange(total + 2), border[0]),
            (np.full(total + 2, total + 1), np.arange(total + 2), border[1]),
        ]
        i, j, value = (np.concatenate([part[k] for part in parts]) for k in range(3))
        value = np.where(i < total, value, BORDER * value)
        matrix = csc_matrix((value, (i, j)), shape=(total + 2, total + 2))
        try:
            return Factors(splu(matrix, permc_spec="NATURAL"), BORDER)
        except RuntimeError:
            raise NumericalError("the equations of the orbit are singular") from None

    def _condense(
        self, row: Vector, by_period: float, by_parameter: float
    ) -> tuple[Vector, tuple[float, float]]:
        """Return a row (n, degree + 1, n_kept) on the mesh points, and its last two elements."""
        n = self.size
        inner = row[:, 1:].reshape(self.orbit.intervals, -1)
        shifted = np.einsum("jq,jqc->jc", inner, self.solved[:, :, : n + 2])
        mesh = row[:, 0] - shifted[:, :n]
        return mesh.ravel(), (
            by_period - float(shifted[:, n].sum()),
            by_parameter - float(shifted[:, n + 1].sum()),
        )

    def residual_of(self, row: Vector) -> float:
        """Return what the residuals of the inner points add to a row."""
        inner = row[:, 1:].reshape(self.orbit.intervals, -1)
        return float(np.einsum("jq,jq->", inner, self.solved[:, :, -1]))

    def expand(self, mesh: Vector, period: float, parameter: float, residual: float) -> Direction:
        """Return the change of the orbit from that at the mesh points, all scaled.

        ``residual`` is 1 for a Newton step and 0 for a direction along the solutions.
        """
        n, count, m = self.size, self.orbit.intervals, self.orbit.basis.degree
        whole = np.concatenate(
            [
                mesh.reshape(count, n),
                np.full((count, 1), period),
                np.full((count, 1), parameter),
                np.full((count, 1), residual),
            ],
            axis=1,
        )
        inner = -np.einsum("jqc,jc->jq", self.solved, whole).reshape(count, m, n)
        states = np.empty((count, m, n))
        states[:, 0] = mesh.reshape(count, n)
        states[:, 1:] = inner[:, :-1]
        s = self.scales
        return Direction(
            states.reshape(count * m, n) * s.states, period * s.period, parameter * s.parameter
        )


@dataclass(frozen=True)
class Intervals:
    """The linear equations of all intervals, scaled: ``inner`` δ + ``known`` [δ_begin, ..., 1] = 0.

    ``inner`` (n, degree * n_kept, degree * n_kept) multiplies the points behind the begin of an
    interval; ``known`` (n, degree * n_kept, n_kept + 3) the begin, period, parameter and residual.
    """

    inner: Vector
    known: Vector
    found: Field

    @staticmethod
    def of(field: AutonomousField, orbit: Orbit, scales: Scales) -> Intervals:
        """Return the equations at an orbit."""
        n, count, m = field.size, orbit.intervals, orbit.basis.degree
        basis, s = orbit.basis, scales.states
        places = orbit.at_gauss().reshape(count * m, n)
        found = field.evaluate(places, orbit.unknowns, orbit.parameter)
        rates = found.rates.reshape(count, m, n) / s
        by_state = found.by_state.reshape(count, m, n, n) * (s / s[:, None])
        by_parameter = found.by_parameter.reshape(count, m, n) / s * scales.parameter
        step = orbit.widths[:, None] * orbit.period
        residual = orbit.slopes() / s - step[:, :, None] * rates
        slope = basis.slope[None, :, :, None, None] * np.eye(n)[None, None, None]
        pull = basis.value[None, :, :, None, None] * (step[:, :, None, None] * by_state)[:, :, None]
        whole = np.transpose(slope - pull, (0, 1, 3, 2, 4)).reshape(count, m * n, (m + 1) * n)
        known = np.concatenate(
            [
                whole[:, :, :n],
                -(orbit.widths[:, None, None] * scales.period * rates).reshape(count, m * n, 1),
                -(step[:, :, None] * by_parameter).reshape(count, m * n, 1),
                residual.reshape(count, m * n, 1),
            ],
            axis=2,
        )
        return Intervals(whole[:, :, n:], known, found)

    def solve(self, right: Vector) -> Vector:
        """Return the solution for right sides (n, degree * n_kept, n_columns).

        Raises
        ------
        NumericalError
            If the equations of an interval are singular.
        """
        try:
            return np.asarray(np.linalg.solve(self.inner, right))
        except np.linalg.LinAlgError:
            raise NumericalError("the equations of an interval are singular") from None


def condense(field: AutonomousField, orbit: Orbit, reference: Orbit, scales: Scales) -> Condensed:
    """Return the linear system of a Newton step at an orbit, in scaled variables.

    ``reference`` is an orbit on the same mesh that fixes the phase.
    """
    intervals = Intervals.of(field, orbit, scales)
    reference_rates = reference.slopes() / scales.states
    norm = float(np.sqrt((reference_rates**2).sum()))
    phase = row_of(orbit, reference_rates / norm, with_widths=False)
    solved = intervals.solve(intervals.known)
    return Condensed(orbit, scales, solved, intervals.found, phase)


def row_of(orbit: Orbit, values: Vector, *, with_widths: bool = True) -> Vector:
    """Return the row (n, degree + 1, n_kept) that integrates values at Gauss points times δx."""
    weights = orbit.basis.weights[None, :] * (orbit.widths[:, None] if with_widths else 1.0)
    return np.asarray(np.einsum("jk,ki,jks->jis", weights, orbit.basis.value, values))


def dot(orbit: Orbit, first: Direction, second: Direction, scales: Scales) -> float:
    """Return the scaled product of two changes of an orbit; that of states is their mean."""
    a, b = orbit.at_gauss(first.states), orbit.at_gauss(second.states)
    weights = orbit.widths[:, None] * orbit.basis.weights
    mean = np.einsum("jk,jks,jks->", weights, a / scales.states, b / scales.states)
    return float(
        mean / len(scales.states)
        + first.period * second.period / scales.period**2
        + first.parameter * second.parameter / scales.parameter**2
    )


def arclength_row(orbit: Orbit, tangent: Direction, scales: Scales) -> tuple[Vector, float, float]:
    """Return the row of the product with a direction, for scaled variables."""
    values = orbit.at_gauss(tangent.states) / scales.states / len(scales.states)
    return (
        row_of(orbit, values),
        tangent.period / scales.period,
        tangent.parameter / scales.parameter,
    )


@dataclass(frozen=True)
class Corrected:
    """An orbit that was found, its linear system, and the number of iterations."""

    orbit: Orbit
    system: Condensed
    iterations: int


def correct(
    field: AutonomousField,
    guess: Orbit,
    scales: Scales,
    *,
    along: Direction | None,
    iterations: int = MOST_ITERATIONS,
) -> Corrected:
    """Return the orbit near a guess, on the plane through it across a direction.

    Without a direction the parameter stays.

    Raises
    ------
    NumericalError
        If Newton's method does not converge.
    """
    orbit, count = guess, guess.intervals
    previous = np.inf
    for iteration in range(iterations):
        system = condense(field, orbit, guess, scales)
        last = last_row(orbit, along, scales)
        factors = system.factorised(last)
        n = system.size
        change = Direction(
            orbit.states - guess.states,
            orbit.period - guess.period,
            orbit.parameter - guess.parameter,
        )
        pieces = orbit.pieces(change.states) / scales.states
        right = np.concatenate(
            [
                -system.solved[:, -n:, -1].ravel(),
                [-float((system.phase * pieces).sum()) + system.residual_of(system.phase)],
                [-_off_plane(change, pieces, last, scales) + system.residual_of(last[0])],
            ]
        )
        found = factors.solve(right)
        if not np.isfinite(found).all():
            raise NumericalError("the equations of the orbit are singular")
        step = system.expand(found[: n * count], found[-2], found[-1], 1.0)
        orbit, size = _moved(orbit, system, step, scales)
        if not size < 1e3 or (iteration > 3 and size > 2.0 * previous and size > 1e-6):
            break
        if size < CONVERGED or (size < 1e3 * CONVERGED and size > 0.3 * previous):
            return Corrected(orbit, condense(field, orbit, guess, scales), iteration + 1)
        previous = size
    raise NumericalError("Newton's method for the orbit does not converge")


def tangent_of(found: Corrected, scales: Scales, before: Direction) -> Direction:
    """Return the unit direction along the branch, on the same side as another direction."""
    system, orbit = found.system, found.orbit
    factors = system.factorised(arclength_row(orbit, before, scales))
    right = np.zeros(orbit.intervals * system.size + 2)
    right[-1] = 1.0
    solution = factors.solve(right)
    direction = system.expand(solution[:-2], solution[-2], solution[-1], 0.0)
    length = np.sqrt(dot(orbit, direction, direction, scales))
    return direction.times(1.0 / length)


def last_row(orbit: Orbit, along: Direction | None, scales: Scales) -> tuple[Vector, float, float]:
    """Return the last row: on the plane across a direction, or with the parameter held."""
    if along is not None:
        return arclength_row(orbit, along, scales)
    return np.zeros((orbit.intervals, orbit.basis.degree + 1, orbit.states.shape[1])), 0.0, 1.0


def _off_plane(
    change: Direction, pieces: Vector, last: tuple[Vector, float, float], scales: Scales
) -> float:
    row, by_period, by_parameter = last
    return (
        float((row * pieces).sum())
        + by_period * change.period / scales.period
        + by_parameter * change.parameter / scales.parameter
    )


def _moved(orbit: Orbit, system: Condensed, step: Direction, scales: Scales) -> tuple[Orbit, float]:
    """Return the orbit after a Newton step, the unknowns with it, and the size of the step."""
    found = system.follow
    by_state = np.einsum(
        "qzs,qs->qz", found.follow, orbit.at_gauss(step.states).reshape(-1, system.size)
    )
    unknowns = orbit.unknowns - found.gap - by_state - found.follow_parameter * step.parameter
    moved = replace(
        orbit,
        states=orbit.states + step.states,
        unknowns=unknowns,
        period=orbit.period + step.period,
        parameter=orbit.parameter + step.parameter,
    )
    if not moved.period > 0.0:
        raise NumericalError("the period of the orbit does not stay positive")
    size = max(
        float(np.abs(step.states / scales.states).max()),
        abs(step.period) / scales.period,
        abs(step.parameter) / scales.parameter,
    )
    return moved, size
