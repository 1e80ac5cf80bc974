"""Solve an optimal-control problem by an interior-point method, and refine its mesh."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.optimal_control.oracle import Oracle
from vehicledyn.analyse.optimal_control.trajectory import Trajectory
from vehicledyn.analyse.optimal_control.transcription import PointModel, Program

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


def solve_on_mesh(
    model: PointModel,
    guess: Trajectory,
    scales: Floats,
    *,
    tolerance: float,
    most_iterations: int,
    is_warm: bool,
    watch: Watch,
) -> Solution:
    """Return the optimum on the mesh of a guess.

    Parameters
    ----------
    model
        Of the problem to solve.
    guess
        Where to begin.
    scales
        Sizes of the states, shape (n_x,).
    tolerance
        Scaled first-order optimality to reach.
    most_iterations
        Iterations at most.
    is_warm
        Whether the guess is nearly an optimum already.
    watch
        Called after each iteration.
    """
    import casadi

    program = Program(model, guess.mesh, scales)
    oracle = Oracle(program.rows)
    seen = _observer(program, watch)
    options: dict[str, Any] = {
        "ipopt.print_level": 0,
        "print_time": False,
        "ipopt.sb": "yes",
        "ipopt.max_iter": most_iterations,
        "ipopt.tol": tolerance,
        "ipopt.acceptable_tol": 1e2 * tolerance,
        "ipopt.constr_viol_tol": min(tolerance, _FEASIBLE),
        "ipopt.acceptable_constr_viol_tol": _FEASIBLE,
        "ipopt.mu_strategy": "adaptive",
        "ipopt.theta_max_fact": 1.0,  # else steps may leave the motion far behind
        "ipopt.linear_solver": "mumps",
        # smaller pivots miscount the signs of stiff models' eigenvalues, which stops the search
        "ipopt.mumps_pivtol": 1e-2,
        "error_on_fail": False,
        "grad_f": oracle.gradient,
        "jac_g": oracle.jacobian,
        "hess_lag": oracle.hessian,
        "no_nlp_grad": True,
        "iteration_callback": seen,
        "iteration_callback_ignore_errors": False,
    }
    if is_warm:
        options |= {"ipopt.mu_strategy": "monotone", "ipopt.mu_init": 1e-4}
    solver = casadi.nlpsol("optimum", "ipopt", oracle.values, options)
    low, high = program.bounds()
    row_low, row_high = program.rows.bounds
    start = np.clip(program.layout.of(guess), low, high)
    found = solver(x0=start, lbx=low, ubx=high, lbg=row_low, ubg=row_high)
    for raised in (seen.error, oracle.error):
        if raised is not None:
            raise raised
    stats = solver.stats()
    status = str(stats["return_status"])
    rows = np.array(found["g"]).ravel()
    violation = float(np.maximum(row_low - rows, rows - row_high).max(initial=0.0))
    failure = _ENDS.get(status, status.replace("_", " ").lower())
    return Solution(
        program.layout.trajectory(np.array(found["x"]), guess.mesh),
        float(found["f"]),
        int(stats["iter_count"]),
        violation,
        failure,
    )


def _observer(program: Program, watch: Watch) -> Any:
    """Return what IPOPT calls after each iteration."""
    import casadi

    row_low, row_high = program.rows.bounds

    class Observer(casadi.Callback):
        """Report the iterations of a search."""

        def __init__(self) -> None:
            casadi.Callback.__init__(self)
            self.count = 0
            self.error: BaseException | None = None
            self.construct("observer", {})

        def get_n_in(self) -> int:
            return int(casadi.nlpsol_n_out())

        def get_n_out(self) -> int:
            return 1

        def get_name_in(self, index: int) -> str:
            return str(casadi.nlpsol_out(index))

        def get_sparsity_in(self, index: int) -> Any:
            sizes = {
                "f": 1,
                "x": program.layout.size,
                "lam_x": program.layout.size,
                "g": len(row_low),
                "lam_g": len(row_low),
            }
            return casadi.Sparsity.dense(sizes.get(casadi.nlpsol_out(index), 0), 1)

        def eval(self, arguments: Any) -> list[int]:
            named = dict(zip(casadi.nlpsol_out(), arguments, strict=True))
            rows = np.array(named["g"]).ravel()
            violation = float(np.maximum(row_low - rows, rows - row_high).max(initial=0.0))
            variables = np.array(named["x"])
            try:
                watch(
                    self.count,
                    float(named["f"]),
                    violation,
                    lambda: program.layout.trajectory(variables, program.mesh),
                )
            except (Exception, KeyboardInterrupt) as error:  # crosses C++ code
                self.error = error
                return [1]
            self.count += 1
            return [0]

    return Observer()
