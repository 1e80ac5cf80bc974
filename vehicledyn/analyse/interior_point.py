"""IPOPT, which ships with CasADi, for functions that are computed outside of CasADi."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def minimise_by_ipopt(
    evaluate: Callable[[Floats], tuple[float, Floats, Floats, Floats]],
    start: Floats,
    *,
    tolerance: float,
    most_iterations: int,
) -> str:
    """Search the least of a function over variables between 0 and 1, with constraints c >= 0.

    Second derivatives are limited-memory estimates. Returns why the search stopped, nothing where
    it converged; the points are those that the function has seen.

    Parameters
    ----------
    evaluate
        Returns the function, its gradient (n,), constraints (m,) and theirs (m, n) at a point.
        What it raises ends the search and is raised again.
    start
        Where to begin, shape (n,).
    tolerance
        First-order optimality to reach.
    most_iterations
        Iterations at most.

    References
    ----------
    Wächter, Biegler (2006), Mathematical Programming 106, 25-57.
    """
    import casadi

    known = [evaluate(start)]
    n, m = len(start), len(known[0][2])
    raised: list[BaseException] = []

    def guarded(x: Any) -> tuple[float, Floats, Floats, Floats]:
        if not raised:
            try:
                known[:] = [evaluate(np.array(x, dtype=float).ravel())]
            except BaseException as error:  # crosses C++ code
                raised.append(error)
        return known[0]

    class Stop(casadi.Callback):
        """End the search where something was raised."""

        def __init__(self) -> None:
            casadi.Callback.__init__(self)
            self.construct("stop", {})

        def get_n_in(self) -> int:
            return int(casadi.nlpsol_n_out())

        def get_n_out(self) -> int:
            return 1

        def get_sparsity_in(self, index: int) -> Any:
            sizes = {"f": 1, "x": n, "lam_x": n, "g": m, "lam_g": m}
            return casadi.Sparsity.dense(sizes.get(casadi.nlpsol_out(index), 0), 1)

        def eval(self, arguments: Any) -> list[Any]:
            return [casadi.DM(float(bool(raised)))]

    stop = Stop()

    class Slopes(casadi.Callback):
        """Derivatives of the values."""

        def __init__(self) -> None:
            casadi.Callback.__init__(self)
            self.construct("slopes", {})

        def get_n_in(self) -> int:
            return 3

        def get_n_out(self) -> int:
            return 2

        def get_sparsity_in(self, index: int) -> Any:
            return casadi.Sparsity.dense((n, 1, m)[index], 1)

        def get_sparsity_out(self, index: int) -> Any:
            return casadi.Sparsity.dense((1, m)[index], n)

        def eval(self, arguments: Any) -> list[Any]:
            _, gradient, _, jacobian = guarded(arguments[0])
            return [casadi.DM(gradient).T, casadi.DM(np.reshape(jacobian, (m, n)))]

    slopes = Slopes()

    class Function(casadi.Callback):
        """Function and constraints."""

        def __init__(self) -> None:
            casadi.Callback.__init__(self)
            self.construct("values", {})

        def get_n_in(self) -> int:
            return 1

        def get_n_out(self) -> int:
            return 2

        def get_sparsity_in(self, index: int) -> Any:
            return casadi.Sparsity.dense(n, 1)

        def get_sparsity_out(self, index: int) -> Any:
            return casadi.Sparsity.dense((1, m)[index], 1)

        def eval(self, arguments: Any) -> list[Any]:
            value, _, constraints, _ = guarded(arguments[0])
            return [casadi.DM(value), casadi.DM(constraints)]

        def has_jacobian(self) -> bool:
            return True

        def get_jacobian(self, *_: Any) -> Any:
            return slopes

    values = Function()
    x = casadi.MX.sym("x", n)
    objective, constraints = values(x)
    options: dict[str, Any] = {
        "ipopt.print_level": 0,
        "print_time": False,
        "ipopt.sb": "yes",
        "ipopt.max_iter": most_iterations,
        "ipopt.tol": tolerance,
        "ipopt.hessian_approximation": "limited-memory",
        "ipopt.linear_solver": "mumps",
        "error_on_fail": False,
        "iteration_callback": stop,
    }
    solver = casadi.nlpsol("search", "ipopt", {"x": x, "f": objective, "g": constraints}, options)
    solver(x0=start, lbx=0.0, ubx=1.0, lbg=0.0, ubg=np.inf)
    if raised:
        raise raised[0]
    stats = solver.stats()
    return "" if stats["success"] else str(stats["return_status"]).replace("_", " ").lower()
