"""Implicit steps of Newmark's family on the rates of a kernel, with a kept iteration matrix.

Velocities get the generalised-alpha formulas for second-order equations, all other states those
for first-order ones with the same weights, so both are of order two. The loops are solved inside
the rates, so the unknowns of a step are the accelerations of the independent coordinates.

Chung, Hulbert (1993), Journal of Applied Mechanics 60, 371-375; Arnold, Brüls (2007), Multibody
System Dynamics 18, 185-202; Jansen, Whiting, Hulbert (2000), Computer Methods in Applied Mechanics
and Engineering 190, 305-319 (first-order states).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.constrained.constrained_steps import ConstrainedSteps
from vehicledyn.integrate.events import Point
from vehicledyn.integrate.explicit_pair import steepest_state
from vehicledyn.integrate.fixed_step import steps_per_interval
from vehicledyn.integrate.newmark_weights import Constraints, Weights
from vehicledyn.integrate.task import SampleBuffer, Statistics, StepError, Task
from vehicledyn.kernel.derivatives import Derivatives
from vehicledyn.kernel.engine import Count, Vector

_MOST_ITERATIONS = 8
_CLOSE = 1e-12
"""Error of Newton's iteration allowed in each state, for one plus its size."""
_SLOW = 0.1
"""Contraction above which the Jacobian is found anew at the next step."""
_ROUNDING = 1e-10
"""Change that is taken for rounding where it no longer falls."""
_SHORTEST = 1e-4
"""Part of the step below which halving gives up."""


@dataclass(frozen=True)
class _Place:
    """A point with its rates and the auxiliary rates that a step of size ``size`` [s] left."""

    point: Point
    rates: Vector
    auxiliary: Vector
    size: float


class ImplicitSteps:
    """Takes steps of any size, keeping Jacobian and factors while Newton's method converges."""

    def __init__(self, task: Task, weights: Weights) -> None:
        """Derive the Jacobian, or take that which was derived for these equations before."""
        self._task, self._weights = task, weights
        equations = task.kernel.equations
        made = task.kernel.made
        if "total derivatives" not in made:
            made["total derivatives"] = Derivatives(equations)
        self._derivatives: Derivatives = made["total derivatives"]
        self._positions, self._velocities = list(equations.positions), list(equations.velocities)
        is_position = np.isin(np.arange(len(equations.states)), self._positions)
        self._rows = np.flatnonzero(~is_position)
        second = np.isin(self._rows, self._velocities)
        w = weights
        self._new_mass = np.where(second, 1.0 - w.alpha_m, w.first_order_mass)
        self._gamma = np.where(second, w.gamma, w.first_order_gamma)
        self._pairs = np.searchsorted(self._rows, self._velocities)
        self._jacobian: Vector | None = None
        self._factors: Any = None
        self._size = 0.0
        self._is_stale = True

    def start(self, point: Point) -> _Place:
        """Return the place from which the motion starts, or starts anew."""
        unknowns = point.unknowns.copy()
        kernel = self._task.kernel
        rates = kernel.evaluate(point.time, point.state, unknowns, self._task.ledger)
        self._is_stale = True
        return _Place(Point(point.time, point.state, unknowns), rates, rates[self._rows], 0.0)

    def step(self, place: _Place, end: float) -> _Place | None:
        """Return the end of a step, or None where Newton's method does not converge."""
        was_stale = self._is_stale or self._jacobian is None
        found = self._iterate(place, end)
        if found is None and not was_stale:
            self._is_stale = True
            found = self._iterate(place, end)
        return found

    def _iterate(self, place: _Place, end: float) -> _Place | None:
        """Iterate from the auxiliary rates at the start of the step."""
        (time, state, unknowns), w = place.point, self._weights
        h, rows = end - time, self._rows
        ratio = h / place.size if place.size else 1.0
        old = place.rates[rows] + ratio * (place.auxiliary - place.rates[rows])
        self._prepare(place.point, h)
        known = (1.0 - self._new_mass) * old - w.alpha_f * place.rates[rows]
        new, z, before = old.copy(), unknowns.copy(), np.inf
        for iteration in range(_MOST_ITERATIONS):
            x = self._moved(state, h, old, new)
            try:
                rates = self._rates(end, x, z)
            except NumericalError:
                return None
            residual = self._new_mass * new + known - (1.0 - w.alpha_f) * rates[rows]
            change = self._solve(residual)
            new = new - change
            moved = self._moved(state, h, old, new) - x
            size = float(np.abs(moved / (1.0 + np.abs(x))).max(initial=0.0))
            if not np.isfinite(size):
                return None
            contraction = size / before if iteration else 0.0
            self._is_stale = self._is_stale or (contraction > _SLOW and size > _ROUNDING)
            if size * contraction / max(1.0 - contraction, 1e-3) < _CLOSE and iteration:
                return self._accepted(end, x + moved, z, new, h)
            if size == 0.0 or (contraction > 0.5 and size < _ROUNDING):
                return self._accepted(end, x + moved, z, new, h)
            if contraction > 0.9:
                return None
            before = size
        return None

    def _accepted(self, end: float, x: Vector, z: Vector, new: Vector, h: float) -> _Place | None:
        try:
            rates = self._rates(end, x, z)
        except NumericalError:
            return None
        return _Place(Point(end, x, z), rates, new, h)

    def _rates(self, time: float, x: Vector, z: Vector) -> Vector:
        return self._task.kernel.evaluate(time, x, z, self._task.ledger)

    def _moved(self, state: Vector, h: float, old: Vector, new: Vector) -> Vector:
        """Return the state at the end of a step by Newmark's formulas."""
        x, w, pairs = state.copy(), self._weights, self._pairs
        x[self._rows] += h * ((1.0 - self._gamma) * old + self._gamma * new)
        bend = (0.5 - w.beta) * old[pairs] + w.beta * new[pairs]
        x[self._positions] += h * (state[self._velocities] + h * bend)
        return x

    def _prepare(self, point: Point, h: float) -> None:
        """Find Jacobian and factors where they are missing, stale or of another size."""
        from scipy.linalg import lu_factor  # slow to import, so only where it is needed

        if self._is_stale or self._jacobian is None:
            parameters = self._task.kernel.parameters
            self._jacobian = self._derivatives.total(*point, parameters).rates[self._rows]
            self._is_stale, self._size = False, 0.0
        if self._size and abs(h - self._size) <= 1e-9 * self._size:
            return
        by_new = self._jacobian[:, self._rows] * (h * self._gamma)
        bend = self._weights.beta * h**2
        by_new[:, self._pairs] += bend * self._jacobian[:, self._positions]
        matrix = np.diag(self._new_mass) - (1.0 - self._weights.alpha_f) * by_new
        self._factors, self._size = lu_factor(matrix) if matrix.size else None, h

    def _solve(self, residual: Vector) -> Vector:
        from scipy.linalg import lu_solve

        if self._factors is None:
            return residual
        return np.asarray(lu_solve(self._factors, residual, check_finite=False), dtype=float)


class _AnyPlace(Protocol):
    @property
    def point(self) -> Point: ...


P = TypeVar("P", bound=_AnyPlace)


class _Steps(Protocol[P]):
    """Takes steps from place to place, on rates or on residuals with multipliers."""

    def start(self, point: Point) -> P: ...

    def step(self, place: P, end: float) -> P | None: ...


def run_newmark(
    task: Task, name: str, weights: Weights, step: float, constraints: Constraints = "reduced"
) -> Statistics:
    """Integrate a task with steps of one size, halved where Newton's method does not converge.

    Parameters
    ----------
    task
        What to integrate.
    name
        Name of the method for the statistics.
    weights
        Weights of the method.
    step
        Step size [s]; a whole number of steps must make one sampling interval.
    constraints
        "reduced" solves them within the rates; "index3" and "stabilised_index2" take multipliers
        and the coordinates of all bodies as unknowns of the steps.

    Raises
    ------
    NumericalError
        If a step does not converge even in small parts.
    """
    if constraints == "reduced":
        return _run(task, name, ImplicitSteps(task, weights), step)
    return _run(task, name, ConstrainedSteps(task, weights, constraints), step)


def _run(task: Task, name: str, steps: _Steps[P], step: float) -> Statistics:
    per_interval = steps_per_interval(step, task.interval)
    buffer = SampleBuffer(task, task.state, task.unknowns)
    place = steps.start(Point(task.begin, task.state, task.unknowns))
    last: Point | None = None
    try:
        while buffer.next_index <= task.n_intervals and not task.watch.ended_by:
            begin = task.time(buffer.next_index - 1)
            for k in range(1, per_interval + 1):
                end = begin + task.interval * k / per_interval
                place = _advance(task, steps, place, end)
                if task.watch.ended_by:
                    last = place.point
                    break
            else:
                buffer.add(place.point.state, place.point.unknowns)
    finally:
        buffer.flush()
    if last is not None:
        task.deliver_point(last)
    return task.statistics(name)


def _advance(task: Task, steps: _Steps[P], place: P, end: float) -> P:
    """Return the place at the end of a step, taken in parts across events and where it must be."""
    whole = part = end - place.point.time
    while place.point.time < end and not task.watch.ended_by:
        remaining = end - place.point.time
        to = end if part >= remaining * (1.0 - 1e-9) else place.point.time + part
        found = steps.step(place, to)
        if found is None:
            part = 0.5 * (to - place.point.time)
            if part < _SHORTEST * whole:
                raise _stuck(task, place, part)
            continue
        if to < end:
            task.count_steps(1, to - place.point.time)
        if task.watch.active and task.watch.fires(found.point):
            found = _crossed(task, steps, place, to)
        elif task.watch.active:
            task.watch.passed(found.point)
        place, part = found, 2.0 * part
    task.count_steps(1, whole)
    return place


def _crossed(task: Task, steps: _Steps[P], place: P, end: float) -> P:
    """Return the place from which the motion goes on behind the first event of a step."""
    time, size = place.point.time, end - place.point.time
    trial = _trials(task, steps, place, size)
    _, point = task.watch.cross(trial, 0.0, 1.0, size)
    if point.time <= time:
        raise _stuck(task, place, size)
    return steps.start(point)


def _trials(task: Task, steps: _Steps[P], place: P, size: float) -> Callable[[float], Point]:
    def trial(fraction: float) -> Point:
        if fraction <= 0.0:
            return place.point
        found = steps.step(place, place.point.time + fraction * size)
        if found is None:
            raise _stuck(task, place, fraction * size)
        return found.point

    return trial


def _stuck(task: Task, place: _AnyPlace, size: float) -> StepError:
    time, state, unknowns = place.point
    name = steepest_state(task.kernel, time, state, unknowns)
    iterations = int(task.ledger.counts[Count.EVALUATIONS])
    return StepError(
        f"integration stopped at t = {time:.9g} s: Newton's method does not converge even with a "
        f"step of {size:.3g} s ({iterations} evaluations so far); state '{name}' changes fastest "
        "there; shorten the step, make an impact an event, or soften the contact"
    )
