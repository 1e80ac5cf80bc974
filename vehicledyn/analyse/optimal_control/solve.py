"""Solve an optimal-control problem by an interior-point method, and refine its mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.interior_point import minimise
from vehicledyn.analyse.optimal_control.trajectory import Trajectory
from vehicledyn.analyse.optimal_control.transcription import PointModel, Program
from vehicledyn.analyse.optimal_control.whole_program import whole_program

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


_FEASIBLE = 1e-6
"""By how much scaled constraints may be missed, however vague the optimum may be."""


@dataclass(frozen=True)
class Solution:
    """A trajectory, its objective, and how the search ended; ``failure`` is empty if well.

    ``violation`` is the largest scaled one of a constraint, ``iterations`` those of all meshes.
    """

    trajectory: Trajectory
    objective: float
    iterations: int
    violation: float
    failure: str


Watch = Callable[[int, float, float, Callable[[], Trajectory]], None]
"""Called after each iteration with its number, objective, violation and its trajectory."""


@dataclass(frozen=True)
class Settings:
    """How to search: ``scales`` are sizes of the states (n_x,), ``watch`` sees each iteration.

    ``tolerance`` is the scaled first-order optimality to reach, ``most_iterations`` how many it may
    take. ``barrier`` is the parameter of the barrier to begin with where the guess is nearly an
    optimum, None where it is not: then it adapts. ``kept_barrier`` is the one at the end: where it
    is above zero the motion found stays away from its bounds.
    """

    scales: Floats
    tolerance: float
    most_iterations: int
    watch: Watch
    barrier: float | None = None
    kept_barrier: float = 0.0


def solve_on_mesh(model: PointModel, guess: Trajectory, settings: Settings) -> Solution:
    """Return the optimum of a problem on the mesh of a guess, where the search begins."""
    made = Program(model, guess.mesh, settings.scales)
    program = whole_program(made.rows, made.bounds())

    def seen(number: int, variables: Floats, objective: float, constraints: Floats) -> None:
        def at() -> Trajectory:
            return made.layout.trajectory(variables, guess.mesh)

        settings.watch(number, objective, program.violation(constraints), at)

    options: dict[str, Any] = {
        "max_iter": settings.most_iterations,
        "tol": settings.tolerance,
        "acceptable_tol": 1e2 * settings.tolerance,
        "constr_viol_tol": min(settings.tolerance, _FEASIBLE),
        "acceptable_constr_viol_tol": _FEASIBLE,
        "mu_strategy": "adaptive",
        "mu_target": settings.kept_barrier,
        "theta_max_fact": 1.0,  # else steps may leave the motion far behind
    }
    if settings.barrier is not None:
        options |= {"mu_strategy": "monotone", "mu_init": settings.barrier}
    start = np.clip(made.layout.of(guess), *program.bounds)
    found = minimise(program, start, options, seen)
    return Solution(
        made.layout.trajectory(found.variables, guess.mesh),
        found.objective,
        found.iterations,
        program.violation(found.constraints),
        _ENDS.get(found.status, found.status.replace("_", " ").lower()),
    )
