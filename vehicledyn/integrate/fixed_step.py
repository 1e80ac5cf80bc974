"""Fixed-step integration: hands the kernel chunks of steps that take a tenth of a second."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace

from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.integrate.accuracy.monitor import AccuracyMonitor
from vehicledyn.integrate.accuracy.monitored_run import MethodAndStep, Rerun
from vehicledyn.integrate.accuracy.proposed_step import proposed_step
from vehicledyn.integrate.accuracy.windows import StepGrid, WindowStart
from vehicledyn.integrate.course import go_on_from, history_of
from vehicledyn.integrate.events import ConsistentPoint
from vehicledyn.integrate.judged_quantities import Judged
from vehicledyn.integrate.task import SampleBuffer, Sink, Statistics, StepError, Task
from vehicledyn.kernel.engine import Count, Figure, March, Method, SampleRows, Status, Vector

_CHUNK_SECONDS = 0.08
_FIRST_CHUNK = 16
_GROWTH = 8

_SHORTEST, _REACH = 1e-9, 1.25
"""First part of a step behind an event [s], and how much longer the next ones are.

Of order one only: a single long part would turn a flight shorter than the step into one that
ends at rest.
"""


def run_fixed(task: Task, name: str, method: int, step: float | None) -> Statistics:
    """Integrate a task with a fixed step, and judge how accurate it was where it is watched.

    Parameters
    ----------
    task
        What to integrate.
    name
        Name of the method for the statistics.
    method
        The method inside the kernel.
    step
        Step size [s]; a whole number of steps must make one sampling interval. None for what
        the motion at the start needs.

    Raises
    ------
    NumericalError
        If the run cannot go on, or has diverged.
    """
    if step is None:
        point = (task.start, task.state, task.unknowns)
        step = proposed_step(task.kernel, method, point, task.interval)
    per_interval = steps_per_interval(step, task.interval)
    watch = None
    if task.watched:
        grid = StepGrid(method, task.start, task.interval, per_interval, task.n_intervals)
        watch = watch_of(task, grid, _taken_again)
    SampleBuffer(task, task.state, task.unknowns).flush()
    march = March(
        method,
        task.start,
        task.interval,
        per_interval,
        task.state,
        task.unknowns,
        sides=task.watch.sides,
    )
    if task.beginning is not None:
        march.step = first = (task.delivered - 1) * per_interval
        if task.beginning.history is not None:
            go_on_from(task.beginning.history, march, task.watch, first, first + per_interval)
    size, remaining = _FIRST_CHUNK, task.n_intervals * per_interval - march.step
    rows = task.rows(task.n_intervals + 1)
    actual = task.interval / per_interval
    while remaining and not task.watch.ended_by:
        size = min(size, remaining, (len(rows.states) - 1) * per_interval + 1)
        started = time.perf_counter()
        try:
            status = task.kernel.advance(march, size, rows)
        finally:
            seconds = max(time.perf_counter() - started, 1e-6)
            taken = int(march.ledger.counts[Count.STEPS])
            task.count_steps(taken, actual)
            _settle(task, march, rows)
            task.note(history_of(march, task.watch))
        if status is Status.EVENT:
            _take_step_with_events(task, march)
            task.count_steps(1)
            taken += 1
        elif status is not Status.SOLVED:
            reason = task.kernel.failure(status, march.time(march.step), march.ledger)
            raise StepError(reason + ("" if watch is None else watch.hint()))
        remaining -= taken
        size = max(1, min(_GROWTH * size, int(taken * _CHUNK_SECONDS / seconds)))
    task.sizes = (actual, actual)
    found = None if watch is None else watch.verdict(ended_early=bool(task.watch.ended_by))
    return task.statistics(name, accuracy=found)


@dataclass(frozen=True)
class FixedSteps:
    """A method with a fixed step [s], by its number in the kernel."""

    fixed_method: int
    step: float

    def integrate(self, task: Task) -> Statistics:
        """Integrate a task."""
        return run_fixed(task, "", self.fixed_method, self.step)


def _taken_again(
    place: WindowStart, interval: float, count: int, way: MethodAndStep, sink: Sink
) -> Statistics:
    """Take a part of a run again, see ``Rerun``."""
    own = (place.state.copy(), place.unknowns.copy())
    span = place.time, interval, count
    task = Task(place.kernel, *span, *own, sink, _silent, _silent, watched=False)
    return run_fixed(task, "", way.method, way.step)


def _silent(*_: object) -> None:
    """Report nothing."""


def watch_of(task: Task, grid: StepGrid, rerun: Rerun) -> AccuracyMonitor:
    """Return a watch that sees the samples of a task before its sink does.

    Of a continued run it sees what went before, too, where that is known.
    """
    judged = task.judged or Judged.usual(task.kernel.equations)
    watch = AccuracyMonitor(task.kernel.equations, grid, judged, rerun)
    watch.take_past(task.kernel, task.course)
    sink = task.sink

    def look(times: Vector, states: Vector, unknowns: Vector, outputs: Vector) -> None:
        sound = watch.take(task.kernel, times, states, unknowns, outputs)
        if sound:
            sink(*[part[:sound] for part in (times, states, unknowns, outputs)])
        watch.refuse_divergence()

    task.sink = look
    return watch


def _settle(task: Task, march: March, rows: SampleRows) -> None:
    """Deliver the samples of a chunk, whole or cut short, and add up its account."""
    _account(task, march)
    samples = int(march.ledger.counts[Count.SAMPLES])
    march.ledger.counts[: Count.WHERE] = 0
    largest = march.ledger.figures[Figure.LARGEST_RESIDUAL]
    figures = task.ledger.figures
    figures[Figure.LARGEST_RESIDUAL] = max(figures[Figure.LARGEST_RESIDUAL], largest)
    task.deliver(rows, samples)


def _account(task: Task, march: March) -> None:
    for item in (Count.EVALUATIONS, Count.ITERATIONS):
        task.ledger.counts[item] += march.ledger.counts[item]
        march.ledger.counts[item] = 0


def _take_step_with_events(task: Task, march: March) -> None:
    """Take the step that is due in parts, from event to event, up to its end or that of the run.

    Each trial is a shorter step of the method itself, so its order holds across an event.
    """
    watch, fraction, reach = task.watch, 0.0, 1.0
    step = march.interval / march.per_interval
    while fraction < 1.0 and not watch.ended_by:
        trial, end = _trials(task, march, fraction), min(fraction + reach, 1.0)
        point = trial(end)
        if watch.fires(point):
            fraction, point = watch.cross(trial, fraction, end, step)
            reach = _SHORTEST / step if march.method == Method.SYMPLECTIC_EULER else 1.0
        else:
            fraction, reach = end, _REACH * reach
        march.state[:], march.unknowns[:] = point.state, point.unknowns
    march.memory[:] = 0.0
    march.step += 1
    _account(task, march)
    if watch.ended_by or march.step % march.per_interval == 0:
        task.deliver_point(point)


def _trials(task: Task, march: March, begin: float) -> Callable[[float], ConsistentPoint]:
    def trial(end: float) -> ConsistentPoint:
        part = replace(march)
        status = task.kernel.advance_part(part, (begin, end))
        if status is not Status.SOLVED:
            moment = march.time(march.step, begin)
            raise NumericalError(task.kernel.failure(status, moment, march.ledger))
        moment = march.time(march.step, end) if end < 1.0 else march.time(march.step + 1)
        return ConsistentPoint(moment, part.state, part.unknowns)

    return trial


def steps_per_interval(step: float, interval: float) -> int:
    """Return how many steps make an interval.

    Raises
    ------
    InputError
        If the number is not whole; names the nearest step that works.
    """
    number = max(1, round(interval / step))
    if abs(number * step - interval) > 1e-9 * interval:
        raise InputError(
            f"the step {step:g} s does not divide the sampling interval {interval:g} s; "
            f"the nearest step that does is {interval / number:.9g} s"
        )
    return number
