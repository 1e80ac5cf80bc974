"""Damped Newton method that does not depend on the scales of its equations.

A step is accepted where the simplified Newton correction shrinks (natural monotonicity test),
which needs no scaling of the residuals: Deuflhard (2004), Newton Methods for Nonlinear
Problems, section 3.3.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.base.numbers.levenberg import least_squares
from vehicledyn.kernel.engine import Vector

Evaluate: TypeAlias = Callable[[Vector], tuple[Vector, Vector]]
"""Returns residual (n,) and Jacobian (n, n) at a point; raises NumericalError where none is."""

_SMALLEST_PART = 1e-5
_SETTLING_STEPS = 400
_SETTLED = 1e-6
_AGREES, _DIFFERS = 0.1, 0.5
"""Parts of the residual by which it may miss its linear prediction for the next step to be longer,
and for a longer one to be taken back."""

_LONGER, _FAR = 3.0, 20.0
"""How much longer, and up to how many times the first step, so that none leaps over a contact."""


@dataclass(frozen=True)
class NewtonResult:
    """Best point found, its residual, the iterations, and whether it is a solution."""

    point: Vector
    residual: Vector
    iterations: int
    solved: bool


def solve_damped(
    evaluate: Evaluate,
    start: Vector,
    *,
    tolerance: float,
    max_iterations: int = 60,
    largest_step: Any = np.inf,
    persistent: bool = True,
    rounding: float = 0.0,
) -> NewtonResult:
    """Find a point where every residual is at most the tolerance.

    Newton's method with damping, then Levenberg and Marquardt's from the best of its points,
    which ends in the least residual nearby where there is no solution.

    Parameters
    ----------
    evaluate
        Residual and Jacobian.
    start
        Point to start from, where they can be evaluated.
    tolerance
        Largest residual that counts as solved.
    max_iterations
        Newton steps at most.
    largest_step
        How far a step may move each unknown, so that it does not leap to a solution far off.
    persistent
        Whether to go on by Levenberg and Marquardt's method where Newton's fails; a continuation
        rather takes a shorter step.
    rounding
        Changes of the unknowns that are but rounding, relative to their size or, since unknowns
        that vanish hang on places that do not, to one metre or radian: a residual that such
        changes make counts as zero too, |f| ≤ rounding |∂f/∂x| max(|x|, 1) row by row (after
        Oettli, Prager 1964).
    """
    ends = tolerance, rounding
    result = _newton(evaluate, start, ends, max_iterations, largest_step)
    if result.solved or not persistent:
        return result
    nearest = _nearest(evaluate, start)
    again = _newton(evaluate, nearest, ends, max_iterations, largest_step)
    iterations = result.iterations + again.iterations
    return NewtonResult(again.point, again.residual, iterations, again.solved)


def settle(
    evaluate: Evaluate, start: Vector, *, longest: float, largest_step: Any = np.inf
) -> Vector:
    """Return a point where forces nearly balance, found as a strongly damped motion finds it.

    Pseudo-transient continuation: x moves with ẋ = f(x), the residual, in implicit steps
    (1/τ - ∂f/∂x) δ = f that grow as the residual falls, and faster where it falls as its slopes
    foretell. Newton's method would leap where forces begin only after some way, as those of
    contacts do: there the residual is not the one foretold, and a step that was long is taken back.

    Parameters
    ----------
    evaluate
        Residual f, a force or acceleration that drives x to where it vanishes, and Jacobian.
    start
        Point to start from.
    longest
        How far the first step may move any unknown; none is made shorter for a residual that was
        not foretold.
    largest_step
        How far a step may move each unknown at all.

    References
    ----------
    Kelley, Keyes (1998), Convergence analysis of pseudo-transient continuation, SIAM J. Numer.
    Anal. 35(2), 508-523.
    """
    point = start
    residual, jacobian = evaluate(point)
    size = first = _largest(residual)
    part = shortest = longest / max(size, 1e-300)
    for _ in range(_SETTLING_STEPS):
        if size <= _SETTLED * first:
            break
        step = np.linalg.solve(np.eye(point.size) / part - jacobian, residual)
        step = step / max(1.0, float(np.max(np.abs(step) / largest_step, initial=0.0)))
        try:
            trial, slopes = evaluate(point + step)
        except NumericalError:
            part *= 0.1
            continue
        missed = _largest(trial - residual - jacobian @ step) / max(size, 1e-300)
        if missed > _DIFFERS and part > shortest:
            part = max(shortest, 0.1 * part)
            continue
        point, residual, jacobian = point + step, trial, slopes
        before, size = size, _largest(residual)
        growth = min(max(before / max(size, 1e-300), 0.1), 10.0)
        may_grow = missed <= _AGREES and np.abs(step).max() * _LONGER <= _FAR * longest
        part *= max(growth, _LONGER) if may_grow else growth
    return point


def _newton(
    evaluate: Evaluate,
    start: Vector,
    ends: tuple[float, float],
    max_iterations: int,
    largest_step: Any,
) -> NewtonResult:
    point = start
    residual, jacobian = evaluate(point)
    for iteration in range(max_iterations):
        solved = _is_zero(point, residual, jacobian, ends)
        trial = _damped_step(evaluate, point, residual, jacobian, largest_step)
        if trial is None or (solved and _largest(trial[1]) >= _largest(residual)):
            return NewtonResult(point, residual, iteration, solved)
        point, residual, jacobian = trial
        if solved:
            return NewtonResult(point, residual, iteration + 1, True)
    solved = _is_zero(point, residual, jacobian, ends)
    return NewtonResult(point, residual, max_iterations, solved)


def _is_zero(point: Vector, residual: Vector, jacobian: Vector, ends: tuple[float, float]) -> bool:
    """Return whether each residual is at most the tolerance, or what rounding of x makes of it."""
    tolerance, rounding = ends
    made = rounding * (np.abs(jacobian) @ np.maximum(np.abs(point), 1.0)) if rounding else 0.0
    return bool(np.all(np.abs(residual) <= np.maximum(tolerance, made)))


def _damped_step(
    evaluate: Evaluate, point: Vector, residual: Vector, jacobian: Vector, largest_step: Any
) -> tuple[Vector, Vector, Vector] | None:
    """Return the next point with its residual and Jacobian, or None if no step is good."""
    step = _correction(jacobian, residual)
    part = first = 1.0 / max(1.0, float(np.max(np.abs(step) / largest_step, initial=0.0)))
    while part > _SMALLEST_PART * first:
        try:
            trial = point - part * step
            trial_residual, trial_jacobian = evaluate(trial)
        except NumericalError:
            part *= 0.5
            continue
        shrunk = np.linalg.norm(_correction(jacobian, trial_residual))
        if shrunk <= (1.0 - 0.25 * part) * np.linalg.norm(step):
            return trial, trial_residual, trial_jacobian
        part *= 0.5
    return None


def _correction(jacobian: Vector, residual: Vector) -> Vector:
    """Return the Newton correction, the shortest one where the Jacobian is singular."""
    if not (np.isfinite(jacobian).all() and np.isfinite(residual).all()):
        raise NumericalError("the equations are no finite numbers at this point")
    return np.asarray(np.linalg.lstsq(jacobian, residual, rcond=1e-13)[0], dtype=float)


def _nearest(evaluate: Evaluate, start: Vector) -> Vector:
    """Return the point of least squared residual near the start; none is worse than it."""
    scale = np.abs(evaluate(start)[1]).max(axis=1)
    scale[scale == 0.0] = 1.0

    def residual(point: Vector) -> Vector:
        try:
            return np.asarray(evaluate(point)[0] / scale)
        except NumericalError:
            return np.full(point.size, np.nan)

    def jacobian(point: Vector) -> Vector:
        return np.asarray(evaluate(point)[1] / scale[:, None])

    return least_squares(residual, jacobian, start, is_solved=lambda h: not h.any(), scaled=True)[0]


def _largest(residual: Vector) -> float:
    return float(np.abs(residual).max(initial=0.0))
