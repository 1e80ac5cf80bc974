"""Follow the solution of some equations while target values move, through singular places.

Unknowns u fulfil G(u) = target, with at least as many rows as unknowns; rows beyond that follow
from the others. Steps predict along the tangent and correct by Newton's method; a step whose
correction is large against it is halved, so that no other branch of solutions is taken.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import qr

from vehicledyn.kernel.engine import Vector

_LOOKS = 4
"""Steps of each way at least; a pair of singular places within one is not seen."""
_MOST_ITERATIONS = 25
_CLOSED = 1e-13
_ACCEPTED = 1e-10
_SMALLEST_STEP = 1e-10
_CORRECTION = 0.3
"""Largest correction, as part of the step."""
_SINGULAR = 1e-5
"""Ratio of smallest and largest singular value below which a place is singular [1]."""
_DEGRADED = 3e-3
"""The same at a place that is known to be singular but for rounding [1]."""
_BISECTIONS = 48
_NEAR = 1e-6
"""Part of the way before its end within which a singular place is the end itself."""

Function = Callable[[Vector], Vector]


@dataclass(frozen=True)
class BranchEquations:
    """Rows G(u), shape (n_rows,), and their Jacobian, shape (n_rows, n_unknowns)."""

    rows: Function
    jacobian: Function


@dataclass(frozen=True)
class SingularPlace:
    """Where the targets do not determine the unknowns.

    ``part`` of the way, between 0 and 1; ``direction`` in which the unknowns move freely there,
    to first order, shape (n_unknowns,).
    """

    part: float
    unknowns: Vector
    direction: Vector


@dataclass
class PathOutcome:
    """Outcome of following a path: how far it went, where it ended, what it passed.

    ``reached`` is the part of the way that could be gone, 1 if all of it; where it is less,
    ``dead_end`` says whether the last place reached is singular. ``heading`` is the change of
    the unknowns a whole way at its end.
    """

    unknowns: Vector
    heading: Vector | None = None
    reached: float = 1.0
    passed: list[SingularPlace] = field(default_factory=list)
    dead_end: SingularPlace | None = None


def follow(
    equations: BranchEquations,
    unknowns: Vector,
    first: Vector,
    last: Vector,
    heading: Vector | None = None,
) -> PathOutcome:
    """Move the targets in a straight line and the unknowns with them.

    Parameters
    ----------
    equations
        The rows; full rank but at single places.
    unknowns
        Solution for the first targets, shape (n_unknowns,).
    first, last
        Targets of the rows, shape (n_rows,).
    heading
        Change of the unknowns to expect where the way begins at a singular place.
    """
    return _Walk(equations, first, last).go(unknowns, heading)


def tangents(equations: BranchEquations, unknowns: Vector, moves: Vector) -> Vector | None:
    """Return ∂u/∂target times some moves of the targets, None where the place is singular.

    Parameters
    ----------
    equations, unknowns
        The rows and a solution.
    moves
        Changes of the targets by column, shape (n_rows, n_moves).

    Returns
    -------
    array or None
        Changes of the unknowns, shape (n_unknowns, n_moves).
    """
    slopes = equations.jacobian(unknowns)
    if _weakness(slopes) < _SINGULAR:
        return None
    return np.asarray(np.linalg.lstsq(slopes, moves, rcond=None)[0])


def singular_direction(equations: BranchEquations, unknowns: Vector) -> Vector | None:
    """Return the direction that the targets do not determine at a solution, if there is one."""
    slopes = equations.jacobian(unknowns)
    return _weakest(slopes) if _weakness(slopes) < _SINGULAR else None


def solve_targets(equations: BranchEquations, guess: Vector, targets: Vector) -> Vector | None:
    """Return the unknowns for some targets by Newton's method, None if it does not converge."""
    u = guess.copy()
    scale = 1.0 + np.abs(targets)
    for _ in range(_MOST_ITERATIONS):
        miss = (targets - equations.rows(u)) / scale
        if not np.isfinite(miss).all():
            return None
        slopes = equations.jacobian(u) / scale[:, None]
        step = np.linalg.lstsq(slopes, miss, rcond=1e-14)[0]
        u = u + step
        if float(np.abs(step).max(initial=0.0)) < _CLOSED * (1.0 + float(np.abs(u).max())):
            break
    final = np.abs(equations.rows(u) - targets) / scale
    return u if float(final.max(initial=0.0)) < _ACCEPTED else None


class _Walk:
    """One way, followed step by step."""

    def __init__(self, equations: BranchEquations, first: Vector, last: Vector) -> None:
        self.equations, self.first, self.move = equations, first, last - first
        self.kept: list[int] = []
        self.sign = 0.0

    def go(self, unknowns: Vector, heading: Vector | None) -> PathOutcome:
        """Return how far the way could be followed."""
        way = PathOutcome(unknowns.copy())
        if not np.any(self.move):
            return way
        self._choose_rows(way.unknowns)
        done, size = 0.0, 1.0 / _LOOKS
        while done < 1.0:
            part = min(1.0, done + size)
            if 1.0 - part < _SMALLEST_STEP:
                part = 1.0
            heading = self._heading(way.unknowns, heading)
            found = self._step(way.unknowns, heading, done, part)
            if found is None:
                size *= 0.5
                if size < _SMALLEST_STEP:
                    return self._stuck(way, done)
                continue
            self._look(way, found, done, part)
            way.heading = (found - way.unknowns) / (part - done)
            way.unknowns, done = found, part
            size = min(2.0 * size, 1.0 / _LOOKS)
        return way

    def _heading(self, u: Vector, before: Vector | None) -> Vector:
        """Return the change of the unknowns a unit part of the way."""
        slopes = self.equations.jacobian(u)
        if before is not None and _weakness(slopes) < _SINGULAR:
            return before
        return np.asarray(np.linalg.lstsq(slopes, self.move, rcond=1e-14)[0])

    def _step(self, u: Vector, heading: Vector, done: float, part: float) -> Vector | None:
        guess = u + (part - done) * heading
        found = solve_targets(self.equations, guess, self.first + part * self.move)
        if found is None:
            return None
        correction = float(np.linalg.norm(found - guess))
        allowed = _CORRECTION * (part - done) * float(np.linalg.norm(heading))
        return found if correction <= allowed + _ACCEPTED else None

    def _look(self, way: PathOutcome, found: Vector, done: float, part: float) -> None:
        """Note a singular place at the end of a step or within it."""
        slopes = self.equations.jacobian(found)
        if _weakness(slopes) < _SINGULAR:
            way.passed.append(SingularPlace(part, found, _weakest(slopes)))
            self.sign = 0.0
            return
        sign = self._orientation(slopes)
        if self.sign * sign < 0.0:
            place = self._between(way.unknowns, found, done, part)
            if place is not None:
                way.passed.append(place)
            else:
                self._choose_rows(found)
                return
        self.sign = sign

    def _between(self, u: Vector, v: Vector, low: float, high: float) -> SingularPlace | None:
        """Return the place between two solutions where the orientation changes."""
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            guess = 0.5 * (u + v)
            found = solve_targets(self.equations, guess, self.first + middle * self.move)
            if found is None:
                break
            if self._orientation(self.equations.jacobian(found)) * self.sign > 0.0:
                u, low = found, middle
            else:
                v, high = found, middle
        place = 0.5 * (u + v)
        slopes = self.equations.jacobian(place)
        if _weakness(slopes) > _DEGRADED:
            return None
        return SingularPlace(0.5 * (low + high), place, _weakest(slopes))

    def _stuck(self, way: PathOutcome, done: float) -> PathOutcome:
        slopes = self.equations.jacobian(way.unknowns)
        way.reached = done
        way.passed = [place for place in way.passed if place.part < done - _NEAR]
        if _weakness(slopes) < _DEGRADED:
            way.dead_end = SingularPlace(done, way.unknowns, _weakest(slopes))
        return way

    def _choose_rows(self, u: Vector) -> None:
        """Choose as many independent rows as unknowns, whose determinant shows crossings."""
        slopes = self.equations.jacobian(u)
        _, _, order = qr(slopes.T, mode="economic", pivoting=True)
        self.kept = sorted(int(k) for k in order[: slopes.shape[1]])
        self.sign = self._orientation(slopes) if _weakness(slopes) >= _SINGULAR else 0.0

    def _orientation(self, slopes: Vector) -> float:
        square = slopes[self.kept]
        return float(np.linalg.slogdet(square)[0]) if square.size else 1.0


def _weakness(slopes: Vector) -> float:
    """Return the ratio of the smallest and the largest singular value."""
    if not slopes.shape[1]:
        return 1.0
    if slopes.shape[0] < slopes.shape[1] or not np.isfinite(slopes).all():
        return 0.0
    sizes = np.linalg.svd(slopes, compute_uv=False)
    return float(sizes[-1] / sizes[0]) if sizes[0] > 0.0 else 0.0


def _weakest(slopes: Vector) -> Vector:
    """Return the direction that the rows determine least."""
    return np.asarray(np.linalg.svd(slopes)[2][-1])
