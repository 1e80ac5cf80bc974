"""Follow an equilibrium while time moves what drives a system, such as its place on a track."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vehicledyn.analyse.equilibrium import BalancedRates, EquilibriumPoint, largest_steps
from vehicledyn.analyse.newton import NewtonResult, settle, solve_damped
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.derivatives import Slopes
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.symbolic.equations import Equations

_FIRST, _SHORTEST, _LONGEST = 1 / 16, 1 / 128, 1 / 8
"""Parts of the way that steps are long: the first, the last before the search settles, any."""

_ITERATIONS = 15
_MOST_STEPS = 400
_MOST_RESTLESS = 10
"""Places after each other at which nothing comes quite to rest before the search is given up."""


def follow_equilibrium(
    equations: Equations,
    kernel: Kernel,
    begin: EquilibriumPoint,
    *,
    times: tuple[float, float],
    free: Sequence[int],
    balanced: Sequence[int],
    tolerance: float,
    derivatives: Slopes,
    settling: float,
) -> EquilibriumPoint:
    """Return the equilibrium at one time to which that at another leads.

    Natural continuation with a secant as predictor: steps shrink where Newton's method fails and
    grow where it does not. Over what changes at once, such as the curvature where an arc follows a
    straight, the point settles as in strongly damped motion; on the way it may do so not quite, as
    where hardly anything holds it. What is found at the end is an equilibrium where the residual
    says so.

    Parameters
    ----------
    equations, kernel
        The model and its kernel, with the parameters set.
    begin
        Equilibrium at the first time.
    times
        Times to lead from and to; the second may be the earlier one [s].
    free, balanced
        States to move and rates that must vanish, as of
        :func:`~vehicledyn.analyse.equilibrium.find_equilibrium`.
    tolerance
        Largest rate that counts as zero on the way, in units of the states per s.
    derivatives
        Those of the equations.
    settling
        How far a free state may move in the first step of settling [m or rad].

    Raises
    ------
    NumericalError
        If nothing comes to rest at several times between.

    References
    ----------
    Allgower, Georg (1990), Numerical Continuation Methods, section 2.
    """
    problem = BalancedRates(kernel, derivatives, times[0], list(free), list(balanced))
    problem.start(begin.state, begin.unknowns)
    largest = largest_steps(equations, free)
    point, slope = problem.state[problem.free], np.zeros(len(free))
    done, step, iterations, restless = 0.0, _FIRST, begin.iterations, 0
    for _ in range(_MOST_STEPS):
        part = min(step, 1.0 - done)
        time = times[0] + (done + part) * (times[1] - times[0])
        trial = problem.at(time)
        found = _corrected(trial, point + part * slope, tolerance, largest)
        if found is None and part > _SHORTEST:
            step = 0.5 * part
            continue
        if found is None:
            trial = problem.at(time)
            found = _settled(trial, point, tolerance, largest, settling)
            slope = np.zeros(len(free))
            restless = 0 if found.solved else restless + 1
            if restless > _MOST_RESTLESS:
                break
        else:
            slope = (found.point - point) / part
            step, restless = min(2.0 * step, _LONGEST), 0
        problem, point, done = trial, found.point, done + part
        iterations += found.iterations
        if done >= 1.0:
            residual = float(np.abs(found.residual).max(initial=0.0))
            return EquilibriumPoint(*problem.point(point), residual, iterations)
    raise NumericalError(f"no equilibrium at t = {problem.time:.6g} s")


def _corrected(
    problem: BalancedRates, guess: Vector, tolerance: float, largest: Vector
) -> NewtonResult | None:
    """Return the equilibrium near a guess, None if Newton's method finds none."""
    try:
        found = solve_damped(
            problem.quickest,
            guess,
            tolerance=tolerance,
            max_iterations=_ITERATIONS,
            largest_step=largest,
            persistent=False,
        )
    except NumericalError:
        return None
    return found if found.solved else None


def _settled(
    problem: BalancedRates, begin: Vector, tolerance: float, largest: Vector, longest: float
) -> NewtonResult:
    """Return where a strongly damped motion leads, nearly an equilibrium if not quite."""
    near = settle(problem.quickest, begin, longest=longest, largest_step=largest)
    return solve_damped(
        problem.quickest,
        near,
        tolerance=tolerance,
        max_iterations=_ITERATIONS,
        largest_step=largest,
        persistent=False,
    )
