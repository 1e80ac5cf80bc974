"""Runs with implicit steps of Newmark's family, of one size or controlled by their error.

Velocities get the generalised-alpha formulas for second-order equations, all other states those
for first-order ones with the same weights, so both are of order two.

Arnold, Brüls (2007), Multibody System Dynamics 18, 185-202; Géradin, Cardona (2001), Flexible
Multibody Dynamics, chapter 11 (error estimate by the change of the accelerations).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Generic, Protocol, TypeVar

from vehicledyn.integrate.constrained.constrained_steps import ConstrainedSteps
from vehicledyn.integrate.events import Point
from vehicledyn.integrate.explicit_pair import steepest_state
from vehicledyn.integrate.fixed_step import steps_per_interval
from vehicledyn.integrate.newmark_weights import Constraints, Weights
from vehicledyn.integrate.reduced_steps import ReducedSteps
from vehicledyn.integrate.task import SampleBuffer, Statistics, StepError, Task
from vehicledyn.kernel.engine import Count

_SHORTEST = 1e-4
"""Part of the step below which halving gives up where Newton's method asks for it."""
_TINY = 1e-9
"""Part of the longest step below which halving gives up where the error asks for it."""
_FIRST_HALVINGS = 6
_ROOM = 0.08
"""Error below which a step is doubled: by order three it grows eightfold, with some reserve."""


class _AnyPlace(Protocol):
    @property
    def point(self) -> Point: ...


P = TypeVar("P", bound=_AnyPlace)


class _Steps(Protocol[P]):
    """Takes steps from place to place, on rates or on residuals with multipliers."""

    def start(self, point: Point) -> P: ...

    def step(self, place: P, end: float) -> P | None: ...

    def error(self, before: P, after: P) -> float: ...


def run_newmark(
    task: Task,
    name: str,
    weights: Weights,
    step: float,
    *,
    constraints: Constraints = "reduced",
    tolerance: float | None = None,
) -> Statistics:
    """Integrate a task with steps of one size, halved where Newton's method or the error asks.

    Parameters
    ----------
    task
        What to integrate.
    name
        Name of the method for the statistics.
    weights
        Weights of the method.
    step
        Longest step [s]; a whole number of steps must make one sampling interval.
    constraints
        "reduced" solves them within the rates; "index3" and "stabilised_index2" take multipliers
        and the coordinates of all bodies as unknowns of the steps.
    tolerance
        Local error allowed for each state, for one plus its size; None where all steps are of one
        size but for those that Newton's method cannot take.

    Raises
    ------
    NumericalError
        If a step does not converge, or is not good enough, even in small parts.
    """
    if constraints == "reduced":
        return _run(_March(task, ReducedSteps(task, weights), tolerance), name, step)
    return _run(_March(task, ConstrainedSteps(task, weights, constraints), tolerance), name, step)


def _run(march: _March[P], name: str, step: float) -> Statistics:
    task = march.task
    per_interval = steps_per_interval(step, task.interval)
    buffer = SampleBuffer(task, task.state, task.unknowns)
    place = march.steps.start(Point(task.begin, task.state, task.unknowns))
    last: Point | None = None
    try:
        while buffer.next_index <= task.n_intervals and not task.watch.ended_by:
            begin = task.time(buffer.next_index - 1)
            for k in range(1, per_interval + 1):
                end = begin + task.interval * k / per_interval
                place = march.advance(place, end)
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


class _March(Generic[P]):
    """Takes long steps in parts across events and where it must be.

    Sizes are whole steps over powers of two, so that factors serve long.
    """

    def __init__(self, task: Task, steps: _Steps[P], tolerance: float | None) -> None:
        """Begin with a small part where the error is watched, as it is unknown there."""
        self.task, self.steps, self._tolerance = task, steps, tolerance
        self._halvings = 0 if tolerance is None else _FIRST_HALVINGS

    def advance(self, place: P, end: float) -> P:
        """Return the place at the end of a whole step."""
        task = self.task
        whole = end - place.point.time
        while place.point.time < end and not task.watch.ended_by:
            part, remaining = whole * 0.5**self._halvings, end - place.point.time
            to = end if part >= remaining * (1.0 - 1e-9) else place.point.time + part
            found = self.steps.step(place, to)
            error = 2.0 if found is None else self._error(place, found)
            if found is None or error > 1.0:
                self._halve(place, to - place.point.time, whole, found)
                continue
            if self._tolerance is not None or to < end:
                task.count_steps(1, to - place.point.time)
            if task.watch.active and task.watch.fires(found.point):
                found = _crossed(task, self.steps, place, to)
            elif task.watch.active:
                task.watch.passed(found.point)
            place = found
            if error < _ROOM and self._halvings:
                self._halvings -= 1
        if self._tolerance is None:
            task.count_steps(1, whole)
        return place

    def _halve(self, place: P, size: float, whole: float, found: P | None) -> None:
        self._halvings = max(self._halvings, round(math.log2(whole / size))) + 1
        if 0.5**self._halvings < (_SHORTEST if self._tolerance is None else _TINY):
            raise _stuck(self.task, place, 0.5 * size, is_inexact=found is not None)

    def _error(self, before: P, after: P) -> float:
        """Return the error of a step as a part of what is allowed; none where it is not watched."""
        if self._tolerance is None:
            return 0.0
        return self.steps.error(before, after) / self._tolerance


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


def _stuck(task: Task, place: _AnyPlace, size: float, *, is_inexact: bool = False) -> StepError:
    time, state, unknowns = place.point
    name = steepest_state(task.kernel, time, state, unknowns)
    iterations = int(task.ledger.counts[Count.EVALUATIONS])
    why = "the error stays too large" if is_inexact else "Newton's method does not converge"
    return StepError(
        f"integration stopped at t = {time:.9g} s: {why} even with a step of {size:.3g} s "
        f"({iterations} evaluations so far); state '{name}' changes fastest there; shorten the "
        "step, make an impact an event, or soften the contact"
    )
