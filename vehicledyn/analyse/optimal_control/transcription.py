"""Direct collocation at Radau points: an optimal-control problem as a sparse nonlinear program.

In each interval the states are the polynomial through its beginning and DEGREE Radau points (the
last of them the end), at which rates and residuals are those of the model; algebraic unknowns are
variables there. Integrals are Radau sums. Source: Betts (2010), Practical Methods for Optimal
Control and Estimation Using Nonlinear Programming, chapters 3 and 4; Garg et al. (2011),
Computational Optimization and Applications 49, 335-358, for Radau points.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.optimal_control.point_function import (
    PointQuantities,
    model_function,
    path_functions,
)
from vehicledyn.analyse.optimal_control.problem import BEND, POINTS, RAMP, ControlProblem
from vehicledyn.analyse.optimal_control.trajectory import DEGREE, Trajectory, radau_points

Floats = NDArray[np.float64]


@dataclass
class _Rows:
    """Constraints of a program with their bounds."""

    expressions: list[Any] = field(default_factory=list)
    low: list[Floats] = field(default_factory=list)
    high: list[Floats] = field(default_factory=list)

    def add(self, expression: Any, low: float | Floats = 0.0, high: float | Floats = 0.0) -> None:
        """Add rows with bounds, or equations to zero."""
        import casadi

        column = casadi.vec(expression)
        if column.numel():
            self.expressions.append(column)
            self.low.append(np.broadcast_to(low, column.numel()).astype(float))
            self.high.append(np.broadcast_to(high, column.numel()).astype(float))


class Layout:
    """Where the parts of a trajectory stand among the variables of the program.

    Parts by name: (shape, scale). All variables are divided by their scales.
    """

    def __init__(self, problem: ControlProblem, n_intervals: int, scales: Floats) -> None:
        self.problem, self.n = problem, n_intervals
        n_x, n_z = len(problem.equations.states), len(problem.equations.unknowns)
        n_u = len(problem.controls)
        sizes = np.array([c.size for c in problem.controls])
        on_path = int(problem.path is not None)
        length = 1.0 if problem.path is None else float(np.ptp(problem.path.distance))
        self.parts: dict[str, tuple[tuple[int, ...], Any]] = {
            "duration": ((1,), 1.0),
            "first": ((n_x,), scales),
            "states": ((n_intervals, DEGREE, n_x), scales),
            "unknowns": ((n_intervals, DEGREE, n_z), 1.0),
            "first_distance": ((on_path,), length),
            "distance": ((n_intervals, DEGREE, on_path), length),
            "values": ((n_intervals + 1, n_u), sizes),
            "rates": ((n_intervals + 1, n_u), sizes),
            "accelerations": ((n_intervals, n_u), sizes),
            "inner": ((n_intervals, DEGREE, n_u), sizes),
        }

    @property
    def size(self) -> int:
        """Number of variables."""
        return sum(int(np.prod(shape)) for shape, _ in self.parts.values())

    def pack(self, **values: Any) -> Floats:
        """Return the variables of values by part."""
        return np.concatenate(
            [
                (np.broadcast_to(np.asarray(values[name], dtype=float), shape) / scale).ravel()
                for name, (shape, scale) in self.parts.items()
            ]
        )

    def of(self, trajectory: Trajectory) -> Floats:
        """Return the variables of a trajectory."""
        t, on_path = trajectory, self.problem.path is not None
        return self.pack(
            duration=t.duration,
            first=t.first,
            states=t.states,
            unknowns=t.unknowns,
            first_distance=[t.first_distance] if on_path else [],
            distance=t.distance[..., None] if on_path else np.zeros((self.n, DEGREE, 0)),
            values=t.values,
            rates=t.rates,
            accelerations=t.accelerations,
            inner=t.inner,
        )

    def split(self, variables: Any) -> dict[str, Any]:
        """Return the parts of a column of numbers, in their shapes and SI."""
        found, begin = {}, 0
        for name, (shape, scale) in self.parts.items():
            size = int(np.prod(shape))
            found[name] = np.reshape(variables[begin : begin + size], shape) * scale
            begin += size
        return found

    def trajectory(self, variables: Floats, mesh: Floats) -> Trajectory:
        """Return the trajectory of variables."""
        parts = self.split(np.asarray(variables, dtype=float).ravel())
        on_path = self.problem.path is not None
        parts["duration"] = float(parts["duration"][0])
        parts["first_distance"] = float(parts["first_distance"][0]) if on_path else 0.0
        nothing = np.zeros((self.n, DEGREE))
        parts["distance"] = parts["distance"][..., 0] if on_path else nothing
        return Trajectory(mesh=mesh, **parts)

    def columns(self, variables: Any) -> dict[str, Any]:
        """Return symbolic parts in SI, with the last dimension along the rows."""
        import casadi

        found, begin = {}, 0
        for name, (shape, scale) in self.parts.items():
            size, rows = int(np.prod(shape)), shape[-1]
            block = casadi.reshape(
                variables[begin : begin + size], rows, size // rows if rows else 0
            )
            scales = np.broadcast_to(scale, rows).astype(float)
            found[name] = casadi.repmat(casadi.DM(scales), 1, block.shape[1]) * block
            begin += size
        return found


class Program:
    """The nonlinear program of a problem on a mesh."""

    def __init__(self, problem: ControlProblem, mesh: Floats, scales: Floats) -> None:
        import casadi

        self.problem, self.mesh = problem, mesh
        self.layout = Layout(problem, len(mesh) - 1, scales)
        self.quantities = PointQuantities(problem)
        self.variables = casadi.MX.sym("variables", self.layout.size)
        self.parts = self.layout.columns(self.variables)
        self.rows = _Rows()
        self.steps = self.parts["duration"] * casadi.DM(np.diff(mesh)).T
        controls = self._controls()
        found = self._points(controls)
        self._collocate(found)
        self._continue_controls()
        self._ends(found)
        self.objective = self._objective(found)

    @property
    def constraints(self) -> Any:
        """All constraints as a column."""
        import casadi

        return casadi.vertcat(*self.rows.expressions)

    @property
    def row_bounds(self) -> tuple[Floats, Floats]:
        """Bounds of the constraints."""
        return np.concatenate(self.rows.low), np.concatenate(self.rows.high)

    def bounds(self) -> tuple[Floats, Floats]:
        """Return the bounds of the variables."""
        found = []
        for side in (0, 1):
            far = (-np.inf, np.inf)[side]
            p, n = self.problem, self.layout.n
            edge = [np.array([_sided(c, place)[side] for c in p.controls]) for place in range(3)]
            values = np.tile(edge[1], (n + 1, 1)) if p.controls else np.zeros((n + 1, 0))
            if p.controls:
                values[0], values[-1] = edge[0], edge[2]
            values[:, [k for k, c in enumerate(p.controls) if c.order == POINTS]] = 0.0
            sign = (-1.0, 1.0)[side]
            rate = np.array([sign * c.rate if c.order == BEND else far for c in p.controls])
            rates = np.tile(rate, (n + 1, 1))
            for k, c in enumerate(p.controls):
                if c.order != BEND:
                    rates[:, k] = 0.0
                elif c.start[0] == c.start[1]:
                    rates[0, k] = 0.0
            bend = np.array([sign * c.acceleration if c.order == BEND else 0.0 for c in p.controls])
            found.append(
                self.layout.pack(
                    duration=p.duration[side],
                    first=p.start[:, side],
                    states=self._inside(side),
                    unknowns=far,
                    first_distance=p.path_start[side],
                    distance=far,
                    values=values,
                    rates=rates,
                    accelerations=bend,
                    inner=[
                        edge[1][k] if c.order == POINTS else 0.0 for k, c in enumerate(p.controls)
                    ],
                )
            )
        return found[0], found[1]

    def _inside(self, side: int) -> Floats:
        p = self.problem
        shape = self.layout.parts["states"][0]
        inside = np.broadcast_to(p.bounds[:, side], shape).copy()
        worse = (np.maximum, np.minimum)[side]
        inside[-1, -1] = worse(inside[-1, -1], p.end[:, side])
        return inside

    def _controls(self) -> Any:
        """Return values, rates and accelerations at all collocation points, (3 n_u, n DEGREE)."""
        import casadi

        columns, inner = [], self.parts["inner"]
        value, rate, bend = (self.parts[k] for k in ("values", "rates", "accelerations"))
        for k in range(self.layout.n):
            step = self.steps[k]
            for number, point in enumerate(radau_points()):
                rows: list[list[Any]] = [[], [], []]
                for j, item in enumerate(self.problem.controls):
                    at, after = value[j, k], value[j, k + 1]
                    v, a, since = rate[j, k], bend[j, k], point * step
                    if item.order == BEND:
                        kept = (at + v * since + 0.5 * a * since**2, v + a * since, a)
                    elif item.order == RAMP:
                        kept = (at + point * (after - at), (after - at) / step, 0.0)
                    else:
                        kept = (inner[j, k * DEGREE + number], 0.0, 0.0)
                    for row, part in zip(rows, kept, strict=True):
                        row.append(part)
                columns.append(casadi.vertcat(*rows[0], *rows[1], *rows[2]))
        return casadi.horzcat(*columns)

    def _points(self, controls: Any) -> dict[str, Any]:
        """Return rate, residual, limits, integrand and last quantities of all points."""
        import casadi

        p = self.problem
        model = model_function(p, self.quantities.channels)
        n_x, n_z = len(p.equations.states), len(p.equations.unknowns)
        t, x, z = (casadi.MX.sym("x", k) for k in (1, n_x, n_z))
        w, s = casadi.MX.sym("w", 3 * len(p.controls)), casadi.MX.sym("s", int(p.path is not None))
        rate, residual, shown = model(t, x, z, w)
        at = {
            "state": x,
            "unknown": z,
            "channel": shown,
            "control": w[: len(p.controls)],
            "all": w,
            "path": casadi.MX(0, 1),
        }
        sides = casadi.MX(0, 1)
        if p.path is not None:
            seen, widths = path_functions(p.path)
            gap, offset = seen(s, *(x[k] for k in p.path.place))
            residual = casadi.vertcat(residual, gap)
            at["path"], (right, left) = casadi.vertcat(s, offset), widths(s)
            sides = casadi.vertcat(offset + right, left - offset)
        value = self.quantities.value
        limits = casadi.vertcat(*[value(item.what, at) for item in p.limits])
        final = [item.what for item in p.final] + [w[1] for _, w in p.terms if w[0] == "final"]
        ends = casadi.vertcat(*[value(item, at) for item in final])
        found = [rate, residual, limits, self.quantities.integrand(at), ends, sides]
        point = casadi.Function("point", [t, x, z, s, w], [casadi.MX(item) for item in found])
        parts, total = self.parts, self.layout.n * DEGREE
        inner = (self.mesh[:-1, None] + np.diff(self.mesh)[:, None] * radau_points()).ravel()
        times = parts["duration"] * casadi.DM(inner).T
        got = point.map(total)(
            times, parts["states"], parts["unknowns"], parts["distance"], controls
        )
        names = ("rate", "residual", "limits", "integrand", "ends", "sides")
        return dict(zip(names, got, strict=True))

    def _collocate(self, found: dict[str, Any]) -> None:
        import casadi

        points = [0.0, *radau_points()]
        slopes, _, self.weights = casadi.collocation_coeff(list(points[1:]))
        states, before = self.parts["states"], self.parts["first"]
        scale = self.layout.parts["first"][1]
        for k in range(self.layout.n):
            here = slice(k * DEGREE, (k + 1) * DEGREE)
            inner = states[:, here]
            defect = casadi.mtimes(casadi.horzcat(before, inner), slopes)
            defect -= self.steps[k] * found["rate"][:, here]
            self.rows.add(casadi.mtimes(casadi.diag(casadi.DM(1.0 / scale)), defect))
            before = inner[:, -1]
        self.rows.add(found["residual"])
        for k, item in enumerate(self.problem.limits):
            self.rows.add(found["limits"][k, :], item.low, item.high)
        self.rows.add(found["sides"], 0.0, np.inf)

    def _continue_controls(self) -> None:
        value, rate, bend = (self.parts[k] for k in ("values", "rates", "accelerations"))
        for j, item in enumerate(self.problem.controls):
            for k in range(self.layout.n):
                step, size = self.steps[k], item.size
                if item.order == BEND:
                    moved = value[j, k] + step * rate[j, k] + 0.5 * step**2 * bend[j, k]
                    self.rows.add((value[j, k + 1] - moved) / size)
                    self.rows.add((rate[j, k + 1] - rate[j, k] - step * bend[j, k]) / size)
                elif item.order == RAMP and np.isfinite(item.rate):
                    gain = (value[j, k + 1] - value[j, k]) / size
                    self.rows.add(gain - step * item.rate / size, -np.inf, 0.0)
                    self.rows.add(gain + step * item.rate / size, 0.0, np.inf)

    def _ends(self, found: dict[str, Any]) -> None:
        p, parts = self.problem, self.parts
        for k, item in enumerate(p.final):
            self.rows.add(found["ends"][k, -1], item.low, item.high)
        scale = self.layout.parts["first"][1]
        for index, growth in p.growth.items():
            gained = parts["states"][index, -1] - parts["first"][index] - growth
            self.rows.add(gained / scale[index])
        if p.growth:
            for j, control in enumerate(p.controls):
                if control.order != POINTS:
                    self.rows.add((parts["values"][j, -1] - parts["values"][j, 0]) / control.size)
                if control.order == BEND:
                    self.rows.add((parts["rates"][j, -1] - parts["rates"][j, 0]) / control.size)
        if p.path is not None and not set(p.path.place) <= set(p.growth):
            # the start of a periodic motion is where its end is, which is on the path already
            seen, _ = path_functions(p.path)
            place = (parts["first"][k] for k in p.path.place)
            self.rows.add(seen(parts["first_distance"], *place)[0])

    def _objective(self, found: dict[str, Any]) -> Any:
        import casadi

        total: Any = casadi.MX(0.0)
        last = len(self.problem.final)
        for weight, what in self.problem.terms:
            if what[0] == "time":
                total += weight * self.parts["duration"]
            elif what[0] == "final":
                total += weight * found["ends"][last, -1]
                last += 1
        for k in range(self.layout.n):
            here = slice(k * DEGREE, (k + 1) * DEGREE)
            total += self.steps[k] * casadi.mtimes(found["integrand"][:, here], self.weights)
        return total


def _sided(control: Any, place: int) -> tuple[float, float]:
    """Return the bounds of a control at the start (0), within (1) or at the end (2)."""
    low, high = control.low, control.high
    if place != 1:
        edge = control.start if place == 0 else control.end
        low, high = max(low, edge[0]), min(high, edge[1])
    return low, high
