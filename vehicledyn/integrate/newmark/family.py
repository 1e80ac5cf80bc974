"""Runs with implicit steps of Newmark's family, of one size or controlled by their error.

Velocities get the generalised-alpha formulas for second-order equations, all other states those
for first-order ones with the same weights, so both are of order two.

Arnold, Brüls (2007), Multibody System Dynamics 18, 185-202; Géradin, Cardona (2001), Flexible
Multibody Dynamics, chapter 11 (error estimate by the change of the accelerations).
"""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Callable
from typing import Any, Generic, Protocol, TypeVar

from vehicledyn.base.errors import NumericalError
from vehicledyn.codegen.toolchain.compiler import CompilationError
from vehicledyn.integrate.course import MethodState
from vehicledyn.integrate.events import ConsistentPoint
from vehicledyn.integrate.explicit_pairs.adaptive_run import steepest_state
from vehicledyn.integrate.fixed_step import steps_per_interval
from vehicledyn.integrate.newmark.compiled_constrained import CompiledConstrainedSteps
from vehicledyn.integrate.newmark.compiled_steps import CompiledLoop, CompiledSteps
from vehicledyn.integrate.newmark.constrained_steps import ConstrainedSteps
from vehicledyn.integrate.newmark.reduced_steps import ReducedSteps
from vehicledyn.integrate.newmark.weights import (
    FIRST_HALVINGS,
    SHORTEST,
    TINY,
    Constraints,
    Velocities,
    Weights,
)
from vehicledyn.integrate.task import SampleBuffer, Statistics, StepError, Task
from vehicledyn.kernel.compiled import CompiledEngine
from vehicledyn.kernel.engine import Count, Status, Vector
from vehicledyn.kernel.newmark.newmark_code import Outcome, newmark_code

_log = logging.getLogger(__name__)

_CHUNK_SECONDS, _FIRST_CHUNK, _GROWTH = 0.08, 16, 8

_ROOM = 0.08
"""Error below which a step is doubled: by order three it grows eightfold, with some reserve."""


class _AnyPlace(Protocol):
    @property
    def point(self) -> ConsistentPoint: ...

    @property
    def size(self) -> float: ...


P = TypeVar("P", bound=_AnyPlace)


class _Steps(Protocol[P]):
    """Takes steps from place to place, on rates or on residuals with multipliers."""

    def start(self, point: ConsistentPoint) -> P: ...

    def resumed(self, point: ConsistentPoint, numbers: Vector) -> P: ...

    def carried(self, place: P) -> MethodState: ...

    def step(self, place: P, end: float) -> P | None: ...

    def error(self, before: P, after: P) -> float: ...

    def outputs(self, place: P) -> Vector | None: ...


def run_newmark(
    task: Task,
    name: str,
    weights: Weights,
    step: float,
    *,
    constraints: Constraints = "reduced",
    velocities: Velocities = "own",
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
    velocities
        What the samples of such steps show: "own" or "projected".
    tolerance
        Local error allowed for each state, for one plus its size; None where all steps are of one
        size but for those that Newton's method cannot take.

    Raises
    ------
    NumericalError
        If a step does not converge, or is not good enough, even in small parts.
    """
    if tolerance is None and constraints == "reduced":
        weights = weights.settled(len(task.kernel.equations.states))
    compiled = _compiled_steps(task, weights, constraints, velocities)
    if compiled is not None:
        return _run_compiled(compiled, name, step, tolerance)
    if constraints == "reduced":
        return _run(_March(task, ReducedSteps(task, weights), tolerance), name, step)
    steps = ConstrainedSteps(task, weights, constraints, velocities)
    return _run(_March(task, steps, tolerance), name, step)


def _compiled_steps(
    task: Task, weights: Weights, constraints: Constraints, velocities: Velocities
) -> CompiledLoop[Any] | None:
    """Return steps whose loop is compiled, None where the kernel is not or the compiler fails."""
    engine = task.kernel.engine
    if not isinstance(engine, CompiledEngine):
        return None
    try:
        if constraints == "reduced":
            return CompiledSteps(task, engine, weights, newmark_code())
        steps = ConstrainedSteps(task, weights, constraints, velocities)
        return CompiledConstrainedSteps(task, engine, weights, newmark_code(), steps)
    except CompilationError as error:
        _log.warning("%s; the steps of the run are interpreted, which is slower", error)
        return None


def _run_compiled(
    steps: CompiledLoop[P], name: str, step: float, tolerance: float | None
) -> Statistics:
    """Run as :func:`_run` does; the compiled loop stops where something else must be done."""
    task, record = steps.task, steps.record
    record.per_interval = steps_per_interval(step, task.interval)
    record.last = task.n_intervals * record.per_interval
    record.tolerance = tolerance or 0.0
    record.shortest = SHORTEST if tolerance is None else TINY
    SampleBuffer(task, task.state, task.unknowns).flush()
    begun = _begun(task, steps)
    steps.go_to(begun)
    record.halvings = _first_halvings(tolerance, record.interval / record.per_interval, begun.size)
    record.step = max(0, task.delivered - 1) * record.per_interval
    rows, size = task.rows(task.n_intervals + 1), _FIRST_CHUNK
    while record.step < record.last and not task.watch.ended_by:
        started = time.perf_counter()
        try:
            outcome = steps.advance(rows, size)
        finally:
            seconds = max(time.perf_counter() - started, 1e-6)
            taken = int(steps.ledger.counts[Count.STEPS])
            samples = int(steps.ledger.counts[Count.SAMPLES])
            steps.settle()
            task.deliver(rows, samples)
        size = max(1, min(_GROWTH * size, int(max(taken, 1) * _CHUNK_SECONDS / seconds)))
        if outcome is Outcome.CROSSED:
            _cross_compiled(steps)
        else:
            _refuse(steps, outcome)
    if task.watch.ended_by and record.is_within:
        if tolerance is None:
            task.count_steps(1, record.whole)
        task.deliver_point(steps.place.point)
    _leave(task, steps, steps.place)
    return task.statistics(name)


def _begun(task: Task, steps: _Steps[P]) -> P:
    """Return the place from which a task goes on: anew, or as the piece of the run before ended."""
    point = ConsistentPoint(task.begin, task.state, task.unknowns)
    numbers = None if task.carried is None else task.carried.numbers
    return steps.start(point) if numbers is None else steps.resumed(point, numbers)


def _leave(task: Task, steps: _Steps[P], place: P) -> None:
    """Leave what the piece of the run to come goes on with."""
    if task.carried is not None:
        found = steps.carried(place)
        task.carried.numbers, task.carried.holds_constraints = (
            found.numbers,
            found.holds_constraints,
        )


def _first_halvings(tolerance: float | None, whole: float, size: float) -> int:
    """Return how often the first step is halved: as the one before was [s], many times at a start.

    The error is unknown at a start where it is watched.
    """
    if size:
        return max(0, round(math.log2(whole / size)))
    return 0 if tolerance is None else FIRST_HALVINGS


def _cross_compiled(steps: CompiledLoop[P]) -> None:
    """Let the events of the step happen that the compiled loop did not take."""
    record, error = steps.record, steps.record.error
    steps.go_to(_crossed(steps.task, steps, steps.place, record.to))
    if error < _ROOM and record.halvings:
        record.halvings -= 1


def _refuse(steps: CompiledLoop[P], outcome: Outcome) -> None:
    """Raise what the interpreted loop raises where a run cannot go on."""
    task, record, ledger = steps.task, steps.record, steps.ledger
    if outcome in (Outcome.STUCK, Outcome.INEXACT):
        size = 0.5 * (record.to - record.at.time[0])
        raise _stuck(task, steps.place, size, is_inexact=outcome is Outcome.INEXACT)
    if outcome in (Outcome.UNSOLVED, Outcome.INACCURATE):
        unsolved = outcome is Outcome.UNSOLVED
        status = Status(record.status) if unsolved else Status.INACCURATE
        moment = task.time(record.step // record.per_interval)
        raise NumericalError(task.kernel.failure(status, moment, ledger))


def _run(march: _March[P], name: str, step: float) -> Statistics:
    task = march.task
    per_interval = steps_per_interval(step, task.interval)
    buffer = SampleBuffer(task, task.state, task.unknowns)
    place = _begun(task, march.steps)
    march.halvings = _first_halvings(march.tolerance, task.interval / per_interval, place.size)
    last: ConsistentPoint | None = None
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
                shown = march.steps.outputs(place)
                buffer.add(place.point.state, place.point.unknowns, shown)
    finally:
        buffer.flush()
    if last is not None:
        task.deliver_point(last)
    _leave(task, march.steps, place)
    return task.statistics(name)


class _March(Generic[P]):
    """Takes long steps in parts across events and where it must be.

    Sizes are whole steps over powers of two, so that factors serve long.
    """

    def __init__(self, task: Task, steps: _Steps[P], tolerance: float | None) -> None:
        """Begin with whole steps; ``halvings`` says how often they are halved."""
        self.task, self.steps, self.tolerance = task, steps, tolerance
        self.halvings = 0

    def advance(self, place: P, end: float) -> P:
        """Return the place at the end of a whole step."""
        task = self.task
        whole = end - place.point.time
        while place.point.time < end and not task.watch.ended_by:
            part, remaining = whole * 0.5**self.halvings, end - place.point.time
            to = end if part >= remaining * (1.0 - 1e-9) else place.point.time + part
            found = self.steps.step(place, to)
            error = 2.0 if found is None else self._error(place, found)
            if found is None or error > 1.0:
                self._halve(place, to - place.point.time, whole, found)
                continue
            if self.tolerance is not None or to < end:
                task.count_steps(1, to - place.point.time)
            if task.watch.active and task.watch.fires(found.point):
                found = _crossed(task, self.steps, place, to)
            place = found
            if error < _ROOM and self.halvings:
                self.halvings -= 1
        if self.tolerance is None:
            task.count_steps(1, whole)
        return place

    def _halve(self, place: P, size: float, whole: float, found: P | None) -> None:
        self.halvings = max(self.halvings, round(math.log2(whole / size))) + 1
        if 0.5**self.halvings < (SHORTEST if self.tolerance is None else TINY):
            raise _stuck(self.task, place, 0.5 * size, is_inexact=found is not None)

    def _error(self, before: P, after: P) -> float:
        """Return the error of a step as a part of what is allowed; none where it is not watched."""
        if self.tolerance is None:
            return 0.0
        return self.steps.error(before, after) / self.tolerance


def _crossed(task: Task, steps: _Steps[P], place: P, end: float) -> P:
    """Return the place from which the motion goes on behind the first event of a step."""
    begin, size = place.point.time, end - place.point.time
    trial = _trials(task, steps, place, size)
    _, point = task.watch.cross(trial, 0.0, 1.0, size)
    if point.time <= begin:
        raise _stuck(task, place, size)
    return steps.start(point if task.watch.ended_by else task.watch.just_behind(point))


def _trials(
    task: Task, steps: _Steps[P], place: P, size: float
) -> Callable[[float], ConsistentPoint]:
    def trial(fraction: float) -> ConsistentPoint:
        if fraction <= 0.0:
            return place.point
        found = steps.step(place, place.point.time + fraction * size)
        if found is None:
            raise _stuck(task, place, fraction * size)
        return found.point

    return trial


def _stuck(task: Task, place: _AnyPlace, size: float, *, is_inexact: bool = False) -> StepError:
    at = place.point
    name = steepest_state(task.kernel, *at)
    iterations = int(task.ledger.counts[Count.EVALUATIONS])
    why = "the error stays too large" if is_inexact else "Newton's method does not converge"
    return StepError(
        f"integration stopped at t = {at.time:.9g} s: {why} even with a step of {size:.3g} s "
        f"({iterations} evaluations so far); state '{name}' changes fastest there; shorten the "
        "step, make an impact an event, or soften the contact"
    )
