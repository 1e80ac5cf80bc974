"""Fixed-step integration: hands the kernel chunks of steps that take a tenth of a second."""

from __future__ import annotations

import time

from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.solve.engine import Count, Figure, March, Method, Rows, Status
from vehicledyn.solve.task import SampleBuffer, Statistics, Task

_CHUNK_SECONDS = 0.08
_FIRST_CHUNK = 16
_GROWTH = 8


def run_fixed(task: Task, name: str, method: Method, step: float) -> Statistics:
    """Integrate a task with a fixed step.

    Parameters
    ----------
    task
        What to integrate.
    name
        Name of the method for the statistics.
    method
        The method inside the kernel.
    step
        Step size [s]; a whole number of steps must make one sampling interval.
    """
    per_interval = steps_per_interval(step, task.interval)
    SampleBuffer(task, task.state, task.unknowns).flush()
    march = March(method, task.start, task.interval, per_interval, task.state, task.unknowns)
    size, remaining = _FIRST_CHUNK, task.n_intervals * per_interval
    rows = task.rows(task.n_intervals + 1)
    steps = 0
    while remaining:
        size = min(size, remaining, (len(rows.states) - 1) * per_interval + 1)
        started = time.perf_counter()
        try:
            status = task.kernel.advance(march, size, rows)
        finally:
            steps += int(march.ledger.counts[Count.STEPS])
            _settle(task, march, rows)
        if status is not Status.SOLVED:
            raise NumericalError(task.kernel.failure(status, march.time(march.step), march.ledger))
        remaining -= size
        seconds = max(time.perf_counter() - started, 1e-6)
        size = max(1, min(_GROWTH * size, int(size * _CHUNK_SECONDS / seconds)))
    actual = task.interval / per_interval
    return task.statistics(name, steps=steps, sizes=(actual, actual))


def _settle(task: Task, march: March, rows: Rows) -> None:
    """Deliver the samples of a chunk, whole or cut short, and add up its account."""
    samples = int(march.ledger.counts[Count.SAMPLES])
    for item in (Count.EVALUATIONS, Count.ITERATIONS):
        task.ledger.counts[item] += march.ledger.counts[item]
    march.ledger.counts[: Count.WHERE] = 0
    largest = march.ledger.figures[Figure.LARGEST_RESIDUAL]
    figures = task.ledger.figures
    figures[Figure.LARGEST_RESIDUAL] = max(figures[Figure.LARGEST_RESIDUAL], largest)
    task.deliver(rows, samples)


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
