"""Rates, residuals and quantities of a model at one collocation point, as one function."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from vehicledyn.analyse.optimal_control.problem import ControlProblem, Expression, Path


def model_function(problem: ControlProblem, channels: Sequence[int]) -> Any:
    """Return (t, x, z, w) to (rate, residual, chosen channels); w are all controls' derivatives.

    w has the shape (3 n_u,): values, rates and accelerations. The other parameters are numbers, so
    that all they decide is folded into the function.
    """
    import casadi

    e, n = problem.equations, len(problem.controls)
    w = casadi.SX.sym("w", 3 * n)
    parameters = casadi.SX(casadi.DM(problem.parameters))
    for k, control in enumerate(problem.controls):
        for index, order, factor in control.entries:
            parameters[index] += factor * w[order * n + k]
    t, x = casadi.SX.sym("t"), casadi.SX.sym("x", len(e.states))
    z = casadi.SX.sym("z", len(e.unknowns))
    shown = casadi.vertcat(*[e.output[k] for k in channels]) if channels else casadi.SX(0, 1)
    given = casadi.Function(
        "given", [e.time, e.state, e.algebraic, e.parameter], [e.rate, e.residual, shown]
    )
    found = [casadi.cse(casadi.densify(item)) for item in given(t, x, z, parameters)]
    # many directions at once come from sparse Jacobians, which cost a third of dense tangents
    sparse = {"jac_penalty": 0.1}
    return casadi.Function("model", [t, x, z, w], found, {**sparse, "reverse_options": sparse})


def path_functions(path: Path) -> tuple[Any, Any]:
    """Return (s, x, y) to (gap along the path, offset to the left), and s to (right, left)."""
    import casadi

    grid = [path.distance.tolist()]
    make = casadi.interpolant
    at_x, at_y = (make(n, "bspline", grid, v.tolist()) for n, v in (("x", path.x), ("y", path.y)))
    right, left = (
        make(n, "bspline", grid, v.tolist()) for n, v in (("r", path.right), ("l", path.left))
    )
    s, x, y = (casadi.MX.sym(name) for name in "sxy")
    centre = casadi.vertcat(at_x(s), at_y(s))
    along = casadi.jacobian(centre, s)
    length = casadi.sqrt(casadi.sumsqr(along))
    away = casadi.vertcat(x, y) - centre
    gap = casadi.dot(away, along) / length
    offset = (along[0] * away[1] - along[1] * away[0]) / length
    seen = casadi.Function("seen", [s, x, y], [gap, offset])
    return seen, casadi.Function("sides", [s], [right(s), left(s)])


class PointQuantities:
    """Expressions of a point, as columns of MX.

    ``channels`` are the indices of the channels that the expressions need.
    """

    def __init__(self, problem: ControlProblem) -> None:
        self.problem = problem
        wanted = [item.what for item in (*problem.limits, *problem.final)]
        wanted += [what[1] for _, what in problem.terms if what[0] in _OF_EXPRESSIONS]
        leaves = [leaf for item in wanted for leaf in _leaves(item)]
        self.channels = sorted({leaf.index for leaf in leaves if leaf.kind == "channel"})

    def value(self, item: Expression, at: dict[str, Any]) -> Any:
        """Return an expression at a point: "state", "unknown", "channel", "control", "path".

        "all" are the controls with their rates and accelerations.
        """
        if item.kind == "square":
            return sum(self.value(part, at) ** 2 for part in item.parts)
        index = self.channels.index(item.index) if item.kind == "channel" else item.index
        return at[item.kind][index]

    def integrand(self, at: dict[str, Any]) -> Any:
        """Return the sum of all terms of the objective that are integrals."""
        total: Any = 0.0
        controls = self.problem.controls
        for weight, what in self.problem.terms:
            if what[0] == "effort":
                parts = [(at["control"][k] / c.size) ** 2 for k, c in enumerate(controls)]
                total += weight * sum(parts)
            elif what[0] == "smoothness":
                total += weight * sum(
                    (at["all"][c.order * len(controls) + k] / c.highest) ** 2
                    for k, c in enumerate(controls)
                    if c.order
                )
            elif what[0] == "power":
                total += weight * what[3] * at["control"][what[1]] * at["state"][what[2]]
            elif what[0] == "integral":
                total += weight * self.value(what[1], at)
            elif what[0] == "square":
                total += weight * self.value(what[1], at) ** 2
        return total


_OF_EXPRESSIONS = ("integral", "square", "final")


def _leaves(item: Expression) -> list[Expression]:
    return [leaf for part in item.parts for leaf in _leaves(part)] if item.parts else [item]
