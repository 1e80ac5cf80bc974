"""All that an optimal-control problem asks of a model at one collocation point, as one function."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from vehicledyn.analyse.optimal_control.path_curves import PathCurves
from vehicledyn.analyse.optimal_control.problem import BEND, RAMP, ControlProblem, PointExpression
from vehicledyn.analyse.optimal_control.rounded import has_least_or_most, rounded
from vehicledyn.symbolic.tables import CurveTable

CONSTANTS = 3
"""Numbers of a point: its part of the duration, that of its interval, its place within this."""


@dataclass(frozen=True)
class PointFunction:
    """Expressions of the variables and constants of a point.

    ``variables`` and ``constants`` are columns of symbols, ``outputs`` a column; ``places`` say
    where its parts are, ``tables`` are all that it looks up.
    """

    outputs: Any
    variables: Any
    constants: Any
    places: dict[str, range]
    tables: tuple[CurveTable, ...]


def collocation_function(problem: ControlProblem, curves: PathCurves | None) -> PointFunction:
    """Return what a collocation point adds to constraints and objective.

    The variables are the duration T, states, unknowns, the distance along the path where there is
    one, and for each control what its values in an interval follow from, see
    :func:`control_variables`. Outputs by name: "rate", T times the rates; "residual" of the model
    and of the place on the path; "limits"; "sides", how far it is to both sides of the corridor;
    "motion", values and rates of the controls of constant acceleration; "integrand", T times it;
    "ends", the quantities bounded at the end and those of the objective there.
    """
    import casadi

    e = problem.equations
    n_x, n_z, on_path = len(e.states), len(e.unknowns), int(curves is not None)
    counts = (1, n_x, n_z, on_path, sum(control_variables(c.order) for c in problem.controls))
    variables, constants = casadi.SX.sym("v", sum(counts)), casadi.SX.sym("c", CONSTANTS)
    duration, x, z, s, own = _parts(variables, counts)
    w = _controls(problem, own, duration, constants)
    quantities = PointQuantities(problem)
    given = casadi.Function(
        "given",
        [e.time, e.state, e.algebraic, e.parameter],
        [e.rate, e.residual, casadi.vertcat(casadi.SX(0, 1), *quantities.shown)],
    )
    rate, residual, shown = given(duration * constants[0], x, z, _parameters(problem, w))
    n = len(problem.controls)
    at = {"state": x, "unknown": z, "channel": shown, "control": w[:n], "all": w}
    sides = casadi.SX(0, 1)
    if curves is not None and problem.path is not None:
        gap, offset = curves.seen(s, *(x[k] for k in problem.path.place))
        right, left = curves.sides(s)
        residual = casadi.vertcat(residual, gap)
        at["path"] = casadi.vertcat(s, offset)
        sides = casadi.vertcat(offset + right, left - offset)
    bent = [k for k, c in enumerate(problem.controls) if c.order == BEND]
    ends = [item.what for item in problem.final]
    ends += [what[1] for _, what in problem.terms if what[0] == "final"]
    outputs = {
        "rate": duration * rate,
        "residual": residual,
        "limits": _column(quantities.value(item.what, at) for item in problem.limits),
        "sides": sides,
        "motion": _column(w[order * n + k] for k in bent for order in (0, 1)),
        "integrand": duration * quantities.integrand(at),
        "ends": _column(quantities.value(item, at) for item in ends),
    }
    tables = (*e.tables, *(() if curves is None else curves.tables))
    return _assembled(outputs, variables, constants, tables)


def start_function(problem: ControlProblem, curves: PathCurves) -> PointFunction:
    """Return how far along the path the start is from its distance; of s, x and y."""
    import casadi

    variables = casadi.SX.sym("v", 3)
    gap, _ = curves.seen(variables[0], variables[1], variables[2])
    return _assembled({"gap": gap}, variables, casadi.SX.sym("c", 0), curves.tables)


def control_variables(order: int) -> int:
    """Return of how many numbers a control's values within an interval follow.

    Value, rate and acceleration at its beginning for constant acceleration, values at both ends
    for a straight line, else the value at the point itself.
    """
    return {BEND: 3, RAMP: 2}.get(order, 1)


def _controls(problem: ControlProblem, own: Any, duration: Any, constants: Any) -> Any:
    """Return values, then rates, then accelerations of all controls, (3 n_u,)."""
    import casadi

    rows: list[list[Any]] = [[], [], []]
    begin, step, part = 0, duration * constants[1], constants[2]
    for item in problem.controls:
        count = control_variables(item.order)
        given = casadi.vertsplit(own[begin : begin + count])
        begin += count
        if item.order == BEND:
            value, rate, bend = given
            since = part * step
            kept = (value + rate * since + 0.5 * bend * since**2, rate + bend * since, bend)
        elif item.order == RAMP:
            value, after = given
            kept = (value + part * (after - value), (after - value) / step, casadi.SX(0.0))
        else:
            kept = (given[0], casadi.SX(0.0), casadi.SX(0.0))
        for row, value in zip(rows, kept, strict=True):
            row.append(value)
    return casadi.vertcat(casadi.SX(0, 1), *rows[0], *rows[1], *rows[2])


def _parameters(problem: ControlProblem, w: Any) -> Any:
    """Return the model's parameters: numbers, but for those that controls enter."""
    import casadi

    parameters = casadi.SX(casadi.DM(problem.parameters))
    for k, control in enumerate(problem.controls):
        for index, order, factor in control.entries:
            parameters[index] += factor * w[order * len(problem.controls) + k]
    return parameters


def has_corners(function: PointFunction) -> bool:
    """Return whether anything is the smaller or the larger of two quantities."""
    return has_least_or_most(function.outputs, [function.variables, function.constants])


def with_rounded_corners(function: PointFunction) -> PointFunction:
    """Return a function whose corners are rounded by a width, which is one more constant."""
    import casadi

    f, width = function, casadi.SX.sym("width")
    outputs = casadi.cse(rounded(f.outputs, [f.variables, f.constants], width))
    return replace(f, outputs=outputs, constants=casadi.vertcat(f.constants, width))


def _assembled(
    outputs: dict[str, Any], variables: Any, constants: Any, tables: tuple[CurveTable, ...]
) -> PointFunction:
    import casadi

    from vehicledyn.symbolic.shared import inlined

    places, begin = {}, 0
    for name, part in outputs.items():
        count = casadi.SX(part).numel()
        places[name] = range(begin, begin + count)
        begin += count
    whole = casadi.densify(casadi.vertcat(*[casadi.SX(part) for part in outputs.values()]))
    return PointFunction(casadi.cse(inlined(whole)), variables, constants, places, tables)


def _parts(column: Any, counts: tuple[int, ...]) -> list[Any]:
    found, begin = [], 0
    for count in counts:
        found.append(column[begin : begin + count])
        begin += count
    return found


def _column(items: Any) -> Any:
    import casadi

    return casadi.vertcat(casadi.SX(0, 1), *items)


class PointQuantities:
    """Expressions of a point; ``shown`` are those of the channels that they need."""

    def __init__(self, problem: ControlProblem) -> None:
        self.problem = problem
        wanted = [item.what for item in (*problem.limits, *problem.final)]
        wanted += [what[1] for _, what in problem.terms if what[0] in _OF_EXPRESSIONS]
        leaves = [leaf for item in wanted for leaf in _leaves(item)]
        self._channels = sorted({leaf.index for leaf in leaves if leaf.kind == "channel"})
        self.shown = [problem.equations.output[k] for k in self._channels]

    def value(self, item: PointExpression, at: dict[str, Any]) -> Any:
        """Return an expression at a point: "state", "unknown", "channel", "control", "path".

        "all" are the controls with their rates and accelerations.
        """
        if item.kind == "square":
            return sum(self.value(part, at) ** 2 for part in item.parts)
        index = self._channels.index(item.index) if item.kind == "channel" else item.index
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


def _leaves(item: PointExpression) -> list[PointExpression]:
    return [leaf for part in item.parts for leaf in _leaves(part)] if item.parts else [item]
