"""Implicit integration with CasADi's integrators where events are watched.

CasADi's own events report no times, and cvodes and idas look for them at samples only. So each
sampling interval is integrated on a grid at least as fine as the method's own steps, and the
points of the grid are watched. Trial points come from calls of the method that start at the
grid point before the event.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from vehicledyn.integrate.casadi_integrators.calls import (
    CallStopped,
    count_work,
    elapsed_equations,
    integrated,
    stopped_between,
)
from vehicledyn.integrate.events import ConsistentPoint
from vehicledyn.integrate.implicit import implicit_equations
from vehicledyn.integrate.task import SampleBuffer, Statistics, Task
from vehicledyn.kernel.engine import Vector

_POINTS, _MOST_POINTS, _REFINEMENT = 8, 512, 4
"""Grid points of a sampling interval, the most of a call, and how much finer the next grid is."""

_INTERVALS = 16
"""Sampling intervals of a call; starting anew more often would cost steps and accuracy."""


def run_casadi_with_events(
    task: Task, plugin: str, options: Mapping[str, float | bool]
) -> Statistics:
    """Integrate a task with an integrator of CasADi, from event to event."""
    buffer = SampleBuffer(task, task.state, task.unknowns)
    stretches = _Stretches(task, plugin, options)
    point, aligned = ConsistentPoint(task.begin, task.state, task.unknowns), True
    try:
        while buffer.next_index <= task.n_intervals and not task.watch.ended_by:
            left = task.n_intervals + 1 - buffer.next_index
            n_intervals = _INTERVALS if aligned and left >= _INTERVALS else 1
            point, aligned = _go_on(stretches, task, point, n_intervals, buffer)
    finally:
        buffer.flush()
    if task.watch.ended_by and point.time > task.begin:
        task.deliver_point(point)
    return task.statistics(plugin)


def _go_on(
    stretches: _Stretches,
    task: Task,
    start: ConsistentPoint,
    n_intervals: int,
    buffer: SampleBuffer,
) -> tuple[ConsistentPoint, bool]:
    """Return the point after some intervals or the next event, and whether it is a sample."""
    point, watch = start, task.watch
    end = task.time(buffer.next_index + n_intervals - 1)
    points = stretches.grid(point, end, n_intervals) if end > start.time else [start]
    for number, following in enumerate(points, 1):
        if watch.fires(following):
            trial = stretches.trials(point, following)
            _, point = watch.cross(trial, 0.0, 1.0, following.time - point.time)
            return point, False
        point = following
        if number * n_intervals % len(points) == 0:
            buffer.add(point.state, point.unknowns)
    return point, True


class _Stretches:
    """Integrators over time from 0 to 1, with the true length as a parameter."""

    def __init__(self, task: Task, plugin: str, options: Mapping[str, float | bool]) -> None:
        self._task, self._plugin, self._options = task, plugin, dict(options)
        self._equations = implicit_equations(task.kernel, task.progress)
        self._constants = self._equations.constants(task.kernel.parameters)
        self._made = task.kernel.made.setdefault((plugin, *self._options.items()), {})

    def grid(self, start: ConsistentPoint, end: float, n_intervals: int) -> list[ConsistentPoint]:
        """Return points up to a time, as close together as the steps that lead there."""
        size = _POINTS * n_intervals
        while True:
            points, steps = self._run(size, start, end)
            if steps <= size or size * _REFINEMENT > _MOST_POINTS:
                return points
            size *= _REFINEMENT

    def trials(
        self, start: ConsistentPoint, end: ConsistentPoint
    ) -> Callable[[float], ConsistentPoint]:
        """Return the points between two points of a grid."""

        def trial(fraction: float) -> ConsistentPoint:
            if fraction in (0.0, 1.0):
                return end if fraction else start
            time = start.time + fraction * (end.time - start.time)
            return self._run(1, start, time)[0][-1]

        return trial

    def _run(
        self, size: int, start: ConsistentPoint, end: float
    ) -> tuple[list[ConsistentPoint], int]:
        if size not in self._made:
            self._task.progress("deriving the integrator", None)
            self._made[size] = self._make(size)
        integrator, length = self._made[size], end - start.time
        try:
            p = [*self._constants, start.time, length]
            result = integrated(integrator, {"x0": start.state, "z0": start.unknowns, "p": p})
            states, guesses = (np.array(result[key]).T.copy() for key in ("xf", "zf"))
            if not np.isfinite(states).all():
                raise CallStopped
        except (RuntimeError, CallStopped):
            raise stopped_between(self._task, (start.time, end), *start[1:]) from None
        steps = count_work(integrator.stats(), self._task)
        times = [start.time + length * k / size for k in range(1, size)] + [end]
        guesses = guesses.reshape(size, start.unknowns.size)
        return [self._point(*item) for item in zip(times, states, guesses, strict=True)], steps

    def _point(self, time: float, state: Vector, guess: Vector) -> ConsistentPoint:
        solved = self._task.kernel.count_solve(time, state, guess, self._task.ledger)
        return ConsistentPoint(time, state, solved)

    def _make(self, size: int) -> Any:
        import casadi

        sym, n = self._equations.symbols.sym, self._equations.n_constants
        part, p = sym("part"), sym("p", n + 2)
        dae = elapsed_equations(self._equations, p, p[n + 1] * part)
        dae.update(t=part, ode=p[n + 1] * dae["ode"])
        grid = [k / size for k in range(1, size + 1)]
        return casadi.integrator(f"grid_{size}", self._plugin, dae, 0.0, grid, self._options)
