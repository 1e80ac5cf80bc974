"""Close a periodic orbit by multiple shooting: its points move until the motion itself returns.

Collocation misses where its mesh is too coarse for a contact that is stiff; integration with error
control does not. With the passages from point to point (:mod:`.monodromy`)

    x_k+1 = φ_k(x_k, T, p),    k = 0 .. n - 1,    x_n = x_0

is solved for all points, the period and, where that is asked, the parameter: then the orbit that
is found is the nearest one on its branch, which exists at a fold too.

References
----------
Seydel (2010), Practical Bifurcation and Stability Analysis, 3rd ed., section 7.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.collocation import Direction
from vehicledyn.analyse.periodic.monodromy import TOLERANCE, Passages, passages
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.engine import Vector

CLOSED = 3e-5
"""Largest gap between the pieces of an orbit, part of the scales, that may count as none."""

SHIFTED = 3e-4
"""Distance of the trivial multiplier from 1 from which on steps are integrated more finely."""

_ALIKE = 1e-4
"""Largest gap of an orbit whose polynomials are kept between the points of its mesh."""

_ROUNDING, _STALLED = 1e-8, 0.1
_ITERATIONS = 8
_ROUGH, _MIDDLE, _FINEST = 1e-2, 1e-4, 1e-6
"""Tolerances of steps while a guess is far from the orbit, when it is nearer, and at last."""

_NEAR = 3e-2
"""Largest gap from which on steps are integrated more finely."""

_FARTHEST = 0.5
"""Largest change of a point, part of the scales, that is taken for a correction."""

_RANK = 1e-13

_SINGULAR = 1e-9
"""Smallest singular value, part of the largest, with which the sign of a determinant is known."""


@dataclass(frozen=True)
class Closed:
    """An orbit that the motion closes, and how it carries changes from point to point.

    ``orbit`` has its points on the mesh, the period and the parameter in common with that of the
    passages; ``iterations`` were made, those apart that only get the motion finer.
    """

    orbit: Orbit
    passages: Passages
    iterations: int = 0


def closed(
    field: AutonomousField,
    orbit: Orbit,
    *,
    parameter_scale: float | None = None,
    along: Direction | None = None,
) -> Closed:
    """Return the closed orbit near one that collocation has found, or near a guess.

    Parameters
    ----------
    field
        The equations.
    orbit
        The orbit, nearly closed.
    parameter_scale
        Size with which changes of the parameter are measured; None to hold the parameter.
    along
        A direction: the orbit that is found lies on the plane across it. Without one it is the
        nearest.

    Raises
    ------
    NumericalError
        If the orbit is not found.
    """
    guess, near, before = orbit, False, np.inf
    tolerance = _MIDDLE if along is None else _ROUGH
    for _ in range(_ITERATIONS):
        found = passages(field, orbit, tolerance=tolerance)
        gap = float(np.abs(found.gaps).max())
        near |= before == np.inf and gap < _ALIKE
        limit = CLOSED if gap > _STALLED * before else max(_ROUNDING, min(CLOSED, found.error))
        if min(tolerance, found.error) <= TOLERANCE and gap < limit:
            if abs(found.trivial - 1.0) < SHIFTED or tolerance <= _FINEST:
                return Closed(_beside(guess, found.orbit) if near else found.orbit, found)
            tolerance *= 0.1
        elif gap < _NEAR:
            tolerance = min(tolerance, TOLERANCE if tolerance <= _MIDDLE else _MIDDLE)
        orbit, before = _corrected(found, guess, parameter_scale, along), gap
    raise NumericalError("the motion along a cycle does not close")


def direction_of(
    found: Closed, parameter_scale: float, before: Direction
) -> tuple[Direction, float]:
    """Return the direction of the branch at an orbit, on the same side as another, and its sense.

    It has the unit length in which that of the states counts as their mean over the period. The
    sense is the sign of the determinant of the closing equations with the direction as their last
    row. It stays the same along a branch, round folds and corners where contacts begin, however
    sharply the direction turns, and changes at a branch point; 0 where it is not known.

    References
    ----------
    Allgower, Georg (1990), Numerical Continuation Methods, chapter 2.
    """
    chain = Chain.of(found.passages, parameter_scale)
    matrix = chain.closing(2)
    matrix /= np.linalg.norm(matrix, axis=1)[:, None]
    _, values, rows = np.linalg.svd(matrix)
    change = rows[-1] if chain.across(before) @ rows[-1] >= 0.0 else -rows[-1]
    known = values[-1] > _SINGULAR * values[0]
    sense = float(np.linalg.slogdet(np.vstack([matrix, change]))[0]) if known else 0.0
    states = chain.points(change[:-2], change[-2:], gaps=False)
    size = np.sqrt(chain.weights @ (states**2).mean(axis=1) + change[-2] ** 2 + change[-1] ** 2)
    orbit, scales = found.passages.orbit, found.passages.scales
    along = Direction(
        states * scales / size,
        float(change[-2] / size * orbit.period),
        float(change[-1] / size * parameter_scale),
    )
    return along, sense


def _beside(guess: Orbit, exact: Orbit) -> Orbit:
    """Return the polynomials of an orbit, moved so that they pass the exact mesh points.

    Where collocation is good its polynomials are nearer to the motion between these than those
    through exact points are, and stay as they are.
    """
    m = guess.basis.degree
    missed = (exact.states - guess.states)[::m]
    ahead, part = np.roll(missed, -1, axis=0), (np.arange(m) / m)[:, None]
    moved = missed[:, None] * (1.0 - part) + ahead[:, None] * part
    return replace(exact, states=guess.states + moved.reshape(guess.states.shape))


def _corrected(
    found: Passages, guess: Orbit, parameter_scale: float | None, along: Direction | None
) -> Orbit:
    """Return the orbit after one step of Newton's method."""
    orbit, size = found.orbit, parameter_scale or 0.0
    chain = Chain.of(found, size)
    matrix = chain.closing(2 if size else 1)
    right = np.append(chain.missed, 0.0)
    if along is not None:
        moved = Direction(
            orbit.states - guess.states,
            orbit.period - guess.period,
            orbit.parameter - guess.parameter,
        )
        matrix = np.vstack([matrix, chain.across(along)])
        right = np.append(right, -chain.product(along, moved) - chain.across_gaps(along))
    change = solved(matrix, right)
    n = len(found.scales)
    outer = np.append(change[n:], 0.0)[:2]
    changes = chain.points(change[:n], outer, gaps=True)
    if not (np.abs(changes).max() < _FARTHEST and abs(outer[0]) < _FARTHEST):
        raise NumericalError("the motion along a cycle does not close")
    return replace(
        orbit,
        states=orbit.states + changes * found.scales,
        period=orbit.period * (1.0 + float(outer[0])),
        parameter=orbit.parameter + size * float(outer[1]),
    )


@dataclass(frozen=True)
class Chain:
    """How all points follow the first one, the period and the parameter, in scaled changes.

    ``whole`` (n_points + 1, n, n), ``pulled`` (n_points + 1, n, 2) and ``gaps`` (n_points + 1, n)
    lead from the changes of the first point, of period and parameter, and from the gaps before
    it, to the change of each point and of the end, or its image where half the motion is known:
    of what comes to the begin.
    """

    found: Passages
    parameter_scale: float
    whole: Vector
    pulled: Vector
    gaps: Vector

    @staticmethod
    def of(found: Passages, parameter_scale: float) -> Chain:
        """Return the chain of some passages."""
        count, n = found.first.shape
        whole, pulled = np.empty((count + 1, n, n)), np.empty((count + 1, n, 2))
        gaps = np.empty((count + 1, n))
        whole[0], pulled[0], gaps[0] = np.eye(n), 0.0, 0.0
        by_period = found.durations[:, None] * found.last
        pulls = np.stack([by_period, parameter_scale * found.by_parameter], axis=2)
        missed = found.gaps
        for k, piece in enumerate(found.by_state):
            whole[k + 1] = piece @ whole[k]
            pulled[k + 1] = piece @ pulled[k] + pulls[k]
            gaps[k + 1] = piece @ gaps[k] + missed[k]
        if found.mirror is None:
            return Chain(found, parameter_scale, whole, pulled, gaps)
        image = found.mirror.scaled(found.scales)
        return Chain(
            found,
            parameter_scale,
            np.concatenate([whole[:-1], image.rows(whole)]),
            np.concatenate([pulled[:-1], image.rows(pulled)]),
            np.concatenate([gaps[:-1], image.image(gaps)]),
        )

    @property
    def missed(self) -> Vector:
        """By how much the end of the last piece misses the first point, shape (n,)."""
        return np.asarray(self.gaps[-1])

    @property
    def weights(self) -> Vector:
        """Parts of the period that the points stand for, shape (n_points,)."""
        durations = self.found.durations
        if self.found.mirror is not None:
            durations = np.tile(durations, 2)
        return np.asarray(0.5 * (durations + np.roll(durations, 1)) / durations.sum())

    def closing(self, free: int) -> Vector:
        """Return the rows that close the orbit and keep its phase, for ``free`` further changes."""
        n = len(self.found.scales)
        first = self.found.first[0]
        matrix = np.zeros((n + 1, n + free))
        matrix[:n, :n] = np.eye(n) - self.whole[-1]
        matrix[:n, n:] = -self.pulled[-1, :, :free]
        matrix[n, :n] = first / np.linalg.norm(first)
        return matrix

    def points(self, own: Vector, outer: Vector, *, gaps: bool) -> Vector:
        """Return the changes of all points, (n_points, n)."""
        moved = self.whole[:-1] @ own + self.pulled[:-1] @ outer
        return np.asarray(moved + self.gaps[:-1] if gaps else moved)

    def across(self, along: Direction) -> Vector:
        """Return the row of the product with a direction."""
        row, outer = self._row(along)
        mesh = np.einsum("ks,ksi->i", row, self.whole[:-1])
        return np.append(mesh, np.einsum("ks,kso->o", row, self.pulled[:-1]) + outer)

    def across_gaps(self, along: Direction) -> float:
        """Return what the gaps add to the product with a direction."""
        return float(np.einsum("ks,ks->", self._row(along)[0], self.gaps[:-1]))

    def product(self, along: Direction, change: Direction) -> float:
        """Return the product of a direction and a change."""
        row, outer = self._row(along)
        states = np.einsum("ks,ks->", row, change.states / self.found.scales)
        sizes = np.array([self.found.orbit.period, self.parameter_scale])
        return float(states + outer @ (np.array([change.period, change.parameter]) / sizes))

    def _row(self, along: Direction) -> tuple[Vector, Vector]:
        """Return the scaled direction: states with their weights, and period and parameter."""
        n = len(self.found.scales)
        states = self.weights[:, None] * along.states / self.found.scales / n
        sizes = np.array([self.found.orbit.period, self.parameter_scale])
        return states, np.array([along.period, along.parameter]) / sizes


def solved(matrix: Vector, right: Vector) -> Vector:
    """Return the solution of some linear equations, the smallest one where it is not unique."""
    return np.asarray(np.linalg.lstsq(matrix, right, rcond=_RANK)[0])
