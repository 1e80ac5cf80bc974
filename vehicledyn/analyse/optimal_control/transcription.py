"""Direct collocation at Radau points: an optimal-control problem as a sparse nonlinear program.

In each interval the states are the polynomial through its beginning and DEGREE Radau points (the
last of them the end), at which rates and residuals are those of the model; algebraic unknowns are
variables there. Integrals are Radau sums. Objective and constraints are linear but for what the
point function gives, so that the derivatives of the program are its own, put in their places.
Source: Betts (2010), Practical Methods for Optimal Control and Estimation Using Nonlinear
Programming, chapters 3 and 4; Garg et al. (2011), Computational Optimization and Applications 49,
335-358, for Radau points.
"""

from __future__ import annotations

from copy import copy
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.optimal_control.bounds import variable_bounds
from vehicledyn.analyse.optimal_control.layout import Layout
from vehicledyn.analyse.optimal_control.path_curves import PathCurves
from vehicledyn.analyse.optimal_control.point_derivatives import PointDerivatives
from vehicledyn.analyse.optimal_control.point_function import (
    PointFunction,
    collocation_function,
    has_corners,
    start_function,
    with_rounded_corners,
)
from vehicledyn.analyse.optimal_control.problem import BEND, POINTS, RAMP, ControlProblem
from vehicledyn.analyse.optimal_control.rows import OBJECTIVE, BoundedRows, PointGroup
from vehicledyn.analyse.optimal_control.trajectory import DEGREE, Trajectory, radau_points

Floats = NDArray[np.float64]
Indices = NDArray[np.int64]


class PointModel:
    """The functions of a problem at its points, with their derivatives; serves all meshes."""

    def __init__(self, problem: ControlProblem) -> None:
        self.problem = problem
        curves = None if problem.path is None else PathCurves(problem.path)
        self.inner: PointFunction = collocation_function(problem, curves)
        self.derivatives = PointDerivatives(self.inner)
        self.start: PointDerivatives | None = None
        self.width, self._widened = 0.0, list[PointModel]()
        place = () if problem.path is None else problem.path.place
        # the start of a periodic motion is where its end is, which is on the path already
        if curves is not None and not set(place) <= set(problem.growth):
            self.start = PointDerivatives(start_function(problem, curves))

    @property
    def may_follow_path(self) -> bool:
        """Whether the motion goes from a place of its path to another, and time does not matter."""
        import casadi

        p, f = self.problem, self.inner
        if p.path is None or not _ends_of(p):
            return False
        places = p.start[list(p.path.place)]
        is_placed = p.path_start[0] == p.path_start[1] or (places[:, 0] == places[:, 1]).all()
        return bool(is_placed) and not casadi.depends_on(f.outputs, f.constants[0])

    @property
    def is_quickest(self) -> bool:
        """Whether the duration is free and time is an objective."""
        low, high = self.problem.duration
        return low < high and any(what[0] == "time" for _, what in self.problem.terms)

    @property
    def has_corners(self) -> bool:
        """Whether something that counts is the smaller or the larger of two quantities."""
        return has_corners(self.inner)

    def rounded(self, width: float) -> PointModel:
        """Return the same with corners rounded by a width, a part of what meets there."""
        if not self._widened:
            made = copy(self)
            made.inner = with_rounded_corners(self.inner)
            made.derivatives = PointDerivatives(made.inner)
            self._widened.append(made)
        other = copy(self._widened[0])
        other.width, other.problem = width, self.problem
        return other

    def within(self, duration: tuple[float, float]) -> PointModel:
        """Return the same of the problem with other bounds of its duration [s]."""
        other = copy(self)
        other.problem = replace(self.problem, duration=duration)
        return other


class MotionProgram:
    """The nonlinear program of a problem on the mesh of a guess.

    Along a path from one place to another the ends of the intervals are places of the path, and
    the times between them variables: what a motion does there is then hardly changed by how quick
    it was before. Else the intervals are parts of the duration. ``rows`` are objective and
    constraints.
    """

    def __init__(self, model: PointModel, guess: Trajectory, scales: Floats) -> None:
        self.model, self.problem, self.mesh = model, model.problem, guess.mesh
        self._distances = guess.distance[:-1, -1]
        ends = [guess.first_distance, *self._distances, *_ends_of(self.problem)]
        follows = bool(model.may_follow_path and (np.diff(ends) > 0.0).all())
        n = guess.n_intervals
        self.layout = Layout(self.problem, guess, scales, follows=follows)
        places = self.layout.places
        self._spans = places["lengths"] if follows else np.repeat(places["duration"], n)
        self.steps = np.ones(n) if follows else np.diff(self.mesh)
        self.rows = BoundedRows(self.layout.scale)
        self._points = self._group()
        self._collocate(scales)
        self._continue_controls()
        self._add_up_lengths()
        self._ends(scales)
        self._objective()
        self.rows.finish()

    def bounds(self) -> tuple[Floats, Floats]:
        """Return the bounds of the variables."""
        return variable_bounds(self.problem, self.layout, self._distances)

    def _group(self) -> PointGroup:
        """Return the collocation points with their variables and constants."""
        p, places = self.problem, self.layout.places
        n, columns = self.layout.n * DEGREE, list[Indices]()
        interval = np.repeat(np.arange(self.layout.n), DEGREE)
        for name in ("states", "unknowns", "distance"):
            columns.append(places[name].reshape(n, -1))
        for j, item in enumerate(p.controls):
            own = [places[name][interval, j] for name in ("values", "rates", "accelerations")]
            if item.order == RAMP:
                own = [own[0], places["values"][interval + 1, j]]
            elif item.order == POINTS:
                own = [places["inner"][:, :, j].ravel()]
            columns += [item[:, None] for item in own]
        parts = np.tile(radau_points(), self.layout.n)
        steps = self.steps[interval]
        known = [self.mesh[interval] + parts * steps, steps, parts]
        if self.model.width:
            known.append(np.full(n, self.model.width))
        constants = np.column_stack(known)
        variables = np.hstack([self._spans[interval][:, None], *columns])
        group = PointGroup(self.model.derivatives, variables, constants)
        self.rows.groups.append(group)
        return group

    def _place(self, name: str) -> Indices:
        """Return the outputs of the point function of a name."""
        return np.array(self.model.inner.places[name], dtype=np.int64)

    def _collocate(self, scales: Floats) -> None:
        import casadi

        slopes = np.array(casadi.collocation_coeff(list(radau_points()))[0])  # (DEGREE + 1, DEGREE)
        states, n = self.layout.places["states"], self.layout.n
        before = np.vstack([self.layout.places["first"][None], states[:-1, -1]])
        through = np.concatenate([before[:, None], states], axis=1)
        for j in range(DEGREE):
            rows = self.rows.equations(n * len(scales)).reshape(n, -1)
            for i in range(DEGREE + 1):
                self.rows.add(rows, through[:, i], slopes[i, j] / scales)
            weights = -self.steps[:, None] / scales
            self._points.send(np.arange(j, n * DEGREE, DEGREE), self._place("rate"), rows, weights)
        points = np.arange(n * DEGREE)
        for name, low, high in self._everywhere():
            outputs = self._place(name)
            rows = self.rows.bounded(np.tile(low, len(points)), np.tile(high, len(points)))
            self._points.send(points, outputs, rows.reshape(len(points), -1), 1.0)

    def _everywhere(self) -> list[tuple[str, Floats, Floats]]:
        """Return the outputs that are bounded at all points, with their bounds."""
        p = self.problem
        zero = np.zeros(len(self._place("residual")))
        sides = np.zeros(len(self._place("sides")))
        limits = [np.array([getattr(item, k) for item in p.limits]) for k in ("low", "high")]
        return [
            ("residual", zero, zero),
            ("limits", limits[0], limits[1]),
            ("sides", sides, np.full_like(sides, np.inf)),
        ]

    def _continue_controls(self) -> None:
        places, n = self.layout.places, self.layout.n
        last, moved = np.arange(DEGREE - 1, n * DEGREE, DEGREE), iter(self._place("motion"))
        for j, item in enumerate(self.problem.controls):
            value, size = places["values"][:, j], item.size
            if item.order == BEND:
                for part in (value, places["rates"][:, j]):
                    rows = self.rows.equations(n)
                    self.rows.add(rows, part[1:], 1.0 / size)
                    self._points.send(last, np.array([next(moved)]), rows[:, None], -1.0 / size)
            elif item.order == RAMP and np.isfinite(item.rate):
                steps = self.steps * item.rate / size
                for sign in (-1.0, 1.0):
                    free = np.full(n, sign * np.inf)
                    zero = np.zeros(n)
                    rows = self.rows.bounded(*((free, zero) if sign < 0.0 else (zero, free)))
                    self.rows.add(rows, value[1:], 1.0 / size)
                    self.rows.add(rows, value[:-1], -1.0 / size)
                    self.rows.add(rows, self._spans, sign * steps)

    def _add_up_lengths(self) -> None:
        """Let the duration be the sum of the intervals' lengths."""
        lengths = self.layout.places["lengths"]
        if lengths.size:
            row = self.rows.equations(1)
            self.rows.add(row, lengths, 1.0)
            self.rows.add(row, self.layout.places["duration"], -1.0)

    def _ends(self, scales: Floats) -> None:
        p, places = self.problem, self.layout.places
        for output, item in zip(self._place("ends"), p.final, strict=False):
            rows = self.rows.bounded(np.array([item.low]), np.array([item.high]))
            self._points.send(self._last, np.array([output]), rows[:, None], 1.0)
        for index, growth in p.growth.items():
            pair = places["states"][-1, -1, index], places["first"][index]
            self._return(pair, growth, scales[index])
        for j, control in enumerate(p.controls if p.growth else ()):
            for name in {POINTS: (), RAMP: ("values",)}.get(control.order, ("values", "rates")):
                self._return((places[name][-1, j], places[name][0, j]), 0.0, control.size)
        if self.model.start is not None and p.path is not None:
            first = [places["first_distance"][0], *(places["first"][k] for k in p.path.place)]
            group = PointGroup(self.model.start, np.array([first]), np.zeros((1, 0)))
            group.send(np.array([0]), np.array([0]), self.rows.equations(1)[:, None], 1.0)
            self.rows.groups.append(group)

    @property
    def _last(self) -> Indices:
        return np.array([self.layout.n * DEGREE - 1])

    def _return(self, pair: tuple[Any, Any], growth: float, scale: float) -> None:
        """Let a variable exceed another by a number."""
        gain = np.array([growth / scale])
        rows = self.rows.bounded(gain, gain)
        self.rows.add(rows, np.array([pair[0]]), 1.0 / scale)
        self.rows.add(rows, np.array([pair[1]]), -1.0 / scale)

    def _objective(self) -> None:
        import casadi

        weights = np.array(casadi.collocation_coeff(list(radau_points()))[2]).ravel()
        own = (self.steps[:, None] * weights).ravel()[:, None]
        points, n_final = np.arange(len(own)), len(self.problem.final)
        row = np.full((len(own), 1), OBJECTIVE)
        self._points.send(points, self._place("integrand"), row, own)
        ends = iter(self._place("ends")[n_final:])
        for weight, what in self.problem.terms:
            if what[0] == "time":
                self.rows.add(np.array([OBJECTIVE]), self.layout.places["duration"], weight)
            elif what[0] == "final":
                output = np.array([next(ends)])
                self._points.send(self._last, output, np.array([[OBJECTIVE]]), weight)


def _ends_of(problem: ControlProblem) -> list[float]:
    """Return the distance along the path at which a motion has to end, if any."""
    ends = [item for item in problem.final if item.what.kind == "path" and item.what.index == 0]
    return [item.low for item in ends[:1] if item.low == item.high]
