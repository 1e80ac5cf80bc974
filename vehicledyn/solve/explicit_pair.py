"""Adaptive integration with SciPy's explicit pairs on the kernel's rates."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.solve.engine import Vector
from vehicledyn.solve.events import Point
from vehicledyn.solve.kernel import Kernel
from vehicledyn.solve.task import SampleBuffer, Statistics, Task

_LOOKS = 8
"""Points at which a step is looked at for events."""


def run_explicit(
    task: Task, name: str, scheme: str, *, relative_tolerance: float, absolute_tolerance: float
) -> Statistics:
    """Integrate a task with an explicit pair of SciPy.

    Parameters
    ----------
    task
        What to integrate.
    name
        Name of the method for the statistics.
    scheme
        Name of the class in ``scipy.integrate``.
    relative_tolerance, absolute_tolerance
        Tolerances of the local error of each state.
    """
    import scipy.integrate

    def begin(point: Point) -> Any:
        return getattr(scipy.integrate, scheme)(
            rates,
            point.time,
            point.state,
            task.time(task.n_intervals),
            rtol=relative_tolerance,
            atol=absolute_tolerance,
        )

    buffer = SampleBuffer(task, task.state, task.unknowns)
    rates = _Rates(task)
    sizes: list[float] = []
    last: Point | None = None
    try:
        if task.n_intervals:
            rates.check_start()
            solver = begin(Point(task.start, task.state, task.unknowns))
            while buffer.next_index <= task.n_intervals and not task.watch.ended_by:
                _advance(solver, rates, task)
                sizes.append(solver.step_size)
                event = _watch_step(solver, rates, task, buffer) if task.watch.active else None
                if event is None:
                    _take_samples(solver, rates, task, buffer)
                else:
                    last, solver = event, begin(event)
    finally:
        buffer.flush()
    if last is not None and task.watch.ended_by:
        task.deliver_point(last)
    sizes = [size for size in sizes if size > 0.0]
    span = (float(min(sizes)), float(max(sizes))) if sizes else None
    return task.statistics(name, steps=len(sizes), sizes=span)


class _Rates:
    """Rates for a trial step; a loop that cannot close there makes the step fail."""

    def __init__(self, task: Task) -> None:
        self._task = task
        self.accepted = task.unknowns.copy()
        self.latest = task.unknowns.copy()
        self.trouble = ""

    def __call__(self, time: float, state: Vector) -> Vector:
        x = np.ascontiguousarray(state)
        if not np.isfinite(x).all():
            return np.full(x.size, math.nan)
        try:
            return self._task.kernel.evaluate(time, x, self.latest, self._task.ledger)
        except NumericalError as error:
            self.trouble = str(error)
            self.latest = self.accepted.copy()
            return np.full(x.size, math.nan)

    def check_start(self) -> None:
        """Raise NumericalError if the rates at the start are no finite numbers."""
        rates = self(self._task.start, self._task.state)
        if not np.isfinite(rates).all():
            where = int(np.flatnonzero(~np.isfinite(rates))[0])
            name = self._task.kernel.equations.states[where].name
            raise NumericalError(
                self.trouble
                or f"the rate of state '{name}' is no finite number at t = {self._task.start:g} s"
            )


def _advance(solver: Any, rates: _Rates, task: Task) -> None:
    """Take one accepted step."""
    rates.accepted = rates.latest.copy()
    rates.trouble = ""
    solver.step()
    if solver.status == "failed":
        reason = rates.trouble or "the step size became too small"
        raise NumericalError(
            f"integration stopped at t = {solver.t:.9g} s: {reason}; "
            f"state '{steepest_state(task.kernel, solver.t, solver.y, rates.accepted)}' "
            "changes fastest there"
        )


def _watch_step(solver: Any, rates: _Rates, task: Task, buffer: SampleBuffer) -> Point | None:
    """Return where the motion starts anew if an event fires in the last step.

    The watched points are looks into the step, as explicit steps of high order are long.
    """
    dense, begin, watch = solver.dense_output(), solver.t_old, task.watch

    def trial(time: float) -> Point:
        state = np.ascontiguousarray(dense(time))
        guess = rates.latest
        return Point(time, state, task.kernel.count_solve(time, state, guess, task.ledger))

    for end in np.linspace(solver.t_old, solver.t, _LOOKS + 1)[1:]:
        point = trial(float(end))
        if watch.fires(point):
            time, point = watch.cross(trial, begin, float(end), 1.0)
            _take_samples_before(time, trial, task, buffer)
            rates.latest = point.unknowns.copy()
            return point
        watch.passed(point)
        begin = float(end)
    return None


def _take_samples_before(
    time: float, trial: Callable[[float], Point], task: Task, buffer: SampleBuffer
) -> None:
    """Enter the samples up to an event; one at its time shows the state after it."""
    while buffer.next_index <= task.n_intervals and task.time(buffer.next_index) < time:
        point = trial(task.time(buffer.next_index))
        buffer.add(point.state, point.unknowns)


def _take_samples(solver: Any, rates: _Rates, task: Task, buffer: SampleBuffer) -> None:
    """Enter the samples inside the last step, from its dense output."""
    inside = solver.status == "running"
    dense = None
    while buffer.next_index <= task.n_intervals:
        moment = task.time(buffer.next_index)
        if inside and moment > solver.t:
            return
        dense = dense or solver.dense_output()
        buffer.add(dense(moment), rates.latest)


def steepest_state(kernel: Kernel, time: float, state: Vector, unknowns: Vector) -> str:
    """Return the name of the state with the largest rate for its size."""
    rates = kernel.rates(time, state, unknowns)
    measure = np.nan_to_num(np.abs(rates) / (1.0 + np.abs(state)), nan=math.inf)
    return kernel.equations.states[int(np.argmax(measure))].name
