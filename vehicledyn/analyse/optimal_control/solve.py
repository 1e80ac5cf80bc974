"""Solve an optimal-control problem by an interior-point method, and refine its mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.interior_point import Seen, minimise
from vehicledyn.analyse.optimal_control.standstill import Iterate, Standstill, StandstillError
from vehicledyn.analyse.optimal_control.trajectory import Trajectory
from vehicledyn.analyse.optimal_control.transcription import MotionProgram, PointModel
from vehicledyn.analyse.optimal_control.whole_program import whole_program
from vehicledyn.base.step_memory import Memory

Floats = NDArray[np.float64]

_ENDS = {
    "Solve_Succeeded": "",
    "Solved_To_Acceptable_Level": "",
    "Infeasible_Problem_Detected": "the constraints cannot all be kept near the best point found",
    "Maximum_Iterations_Exceeded": "it took the most iterations allowed",
    "Restoration_Failed": "it found no way back to points that keep the constraints",
    "Diverging_Iterates": "the motion grew beyond all bounds; bound states that may run away",
    "Invalid_Number_Detected": "the model gave no finite number",
}


FEASIBLE = 1e-6
"""By how much scaled constraints may be missed, however vague the optimum may be."""

_GAP, _SMALLER = 1e-3, 0.1
"""Part of the objective up to which a search that circles may be from its least, to first order,
and by how much the barrier gets smaller where it is more."""


@dataclass(frozen=True)
class Solution:
    """A trajectory, its objective, and how the search ended; ``failure`` is empty if well.

    ``violation`` is the largest scaled one of a constraint, ``iterations`` those of all meshes.
    A search that circled has a ``gap``: by so much the objective may be from its least. ``width``
    is that of rounded corners where it is not an optimum with sharp ones.
    """

    trajectory: Trajectory
    objective: float
    iterations: int
    violation: float
    failure: str
    gap: float | None = None
    width: float = 0.0


Watch = Callable[[int, float, float, Callable[[], Trajectory]], None]
"""Called after each iteration with its number, objective, violation and its trajectory."""


@dataclass(frozen=True)
class Settings:
    """How to search: ``scales`` are sizes of the states (n_x,), ``watch`` sees each iteration.

    ``tolerance`` is the scaled first-order optimality to reach, ``most_iterations`` how many it may
    take. ``barrier`` is the parameter of the barrier to begin with where the guess is nearly an
    optimum, None where it is not: then it adapts. ``kept_barrier`` is the one at the end: where it
    is above zero the motion found stays away from its bounds. ``memory`` keeps the ends of
    searches, of kinds :data:`KEPT`.
    """

    scales: Floats
    tolerance: float
    most_iterations: int
    watch: Watch
    barrier: float | None = None
    kept_barrier: float = 0.0
    memory: Memory = field(default_factory=Memory)


@dataclass(frozen=True)
class KeptSearch:
    """The end of a search with what was seen of it.

    ``seen`` are number, objective and violation of each iteration, ``best`` the motion with the
    least objective among those that keep the constraints, if any.
    """

    solution: Solution
    seen: list[tuple[int, float, float]]
    best: Trajectory | None


KEPT = Trajectory, Solution, KeptSearch


def solve_on_mesh(model: PointModel, guess: Trajectory, settings: Settings) -> Solution:
    """Return the optimum of a problem on the mesh of a guess, where the search begins.

    The end of a search that was kept is recalled, and its iterations are shown once more.
    """
    is_shown, seen, least = False, list[tuple[int, float, float]](), np.inf
    best: Trajectory | None = None

    def watch(number: int, objective: float, violation: float, at: Callable[[], Any]) -> None:
        nonlocal best, least
        seen.append((number, objective, violation))
        if violation <= FEASIBLE and objective < least:
            best, least = at(), objective
        settings.watch(number, objective, violation, at)

    def searched() -> KeptSearch:
        nonlocal is_shown
        is_shown = True
        return KeptSearch(_searched(model, guess, replace(settings, watch=watch)), seen, best)

    s = settings
    numbers = s.tolerance, s.most_iterations, s.barrier, s.kept_barrier
    given = guess, s.scales, numbers, model.width, model.problem.duration
    kept = s.memory.recall("search", given, searched)
    for number, objective, violation in [] if is_shown else kept.seen:
        # of all motions seen only the best one of a search is ever asked for in the end
        s.watch(number, objective, violation, lambda: kept.best or kept.solution.trajectory)
    return kept.solution


def _searched(model: PointModel, guess: Trajectory, settings: Settings) -> Solution:
    """Return the optimum of a problem on the mesh of a guess, where the search begins.

    A search that circles goes on from the motion that it circles about, with a smaller barrier,
    until what the barrier may keep from the objective is small.
    """
    made = MotionProgram(model, guess, settings.scales)
    program = whole_program(made.rows, made.bounds())
    start, spent, barrier = np.clip(made.layout.of(guess), *program.bounds), 0, settings.barrier

    def seen_by(still: Standstill, before: int) -> Seen:
        def seen(number: int, variables: Floats, objective: float, *more: Any) -> None:
            violation, gap = program.violation(more[0]), more[1]
            at = partial(made.layout.trajectory, variables, guess.mesh)
            settings.watch(before + number, objective, violation, at)
            if not settings.kept_barrier:
                still.look(Iterate(variables, objective, violation, gap))

        return seen

    while True:
        still = Standstill(FEASIBLE)
        try:
            seen = seen_by(still, spent)
            found = minimise(program, start, _options(settings, barrier, spent), seen)
        except StandstillError:
            best, spent = still.best, spent + still.count
            assert best is not None
            least = _GAP * abs(best.objective)
            if best.gap <= least or spent >= settings.most_iterations:
                failure = "" if best.gap <= least else _ENDS["Maximum_Iterations_Exceeded"]
                trajectory = made.layout.trajectory(best.variables, guess.mesh)
                return Solution(
                    trajectory, best.objective, spent, best.violation, failure, best.gap
                )
            start, barrier = best.variables, _SMALLER * best.gap / program.n_gaps
            continue
        return Solution(
            made.layout.trajectory(found.variables, guess.mesh),
            found.objective,
            spent + found.iterations,
            program.violation(found.constraints),
            _ENDS.get(found.status, found.status.replace("_", " ").lower()),
        )


def _options(settings: Settings, barrier: float | None, spent: int) -> dict[str, Any]:
    """Return the options of IPOPT behind some iterations."""
    options: dict[str, Any] = {
        "max_iter": max(settings.most_iterations - spent, 0),
        "tol": settings.tolerance,
        "acceptable_tol": 1e2 * settings.tolerance,
        "constr_viol_tol": min(settings.tolerance, FEASIBLE),
        "acceptable_constr_viol_tol": FEASIBLE,
        "mu_strategy": "adaptive",
        "mu_target": settings.kept_barrier,
        "theta_max_fact": 1.0,  # else steps may leave the motion far behind
    }
    if barrier is not None:
        options |= {"mu_strategy": "monotone", "mu_init": barrier}
    return options
