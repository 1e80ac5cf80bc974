"""Implicit integration with CasADi's integrators, loops as algebraic equations.

CasADi integrates a whole chunk of samples in one call that cannot be interrupted, and starts
its method anew with the next chunk; so chunks are short for methods that start cheaply. Its steps
lead to the end of the chunk, so that a longer run has others where this one's last chunk is cut
short: what goes on with the run begins before that.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from vehicledyn.integrate.casadi_integrators.calls import (
    CallStopped,
    count_work,
    elapsed_equations,
    integrated,
    stopped_between,
)
from vehicledyn.integrate.course import reading_history
from vehicledyn.integrate.implicit import implicit_equations
from vehicledyn.integrate.task import SampleBuffer, Statistics, Task
from vehicledyn.kernel.engine import Vector


def run_casadi(
    task: Task, plugin: str, *, chunk: int, options: Mapping[str, float | bool]
) -> Statistics:
    """Integrate a task with an integrator of CasADi.

    Parameters
    ----------
    task
        What to integrate.
    plugin
        Name of the integrator, also for the statistics.
    chunk
        Sampling intervals to integrate in one call.
    options
        Options of the integrator.
    """
    if task.watch.active:
        from vehicledyn.integrate.casadi_integrators.events import run_casadi_with_events

        return run_casadi_with_events(task, plugin, options)
    buffer = SampleBuffer(task, task.state, task.unknowns)
    integrators = _Integrators(task, plugin, options)
    state, unknowns, index = task.state, task.unknowns, max(0, task.delivered - 1)
    if task.beginning is not None and task.beginning.history is not None:
        with reading_history():
            index = range(task.n_intervals + 1)[int(task.beginning.history[0])]
            numbers = task.beginning.history[1:].reshape(state.size + unknowns.size)
            state, unknowns = np.split(numbers, [state.size])

    def note() -> None:
        if task.course is not None:
            buffer.flush()
            task.course.note(task.time(index), np.concatenate([[index], state, unknowns]))

    try:
        if not index:
            note()
        while index < task.n_intervals:
            size = wanted = min(chunk, task.n_intervals - index)
            try:
                result = integrators.run(size, task.time(index), state, unknowns)
            except CallStopped:
                size = 1
                result = _single(integrators, task, index, (state, unknowns))
            states, guesses = result
            for row in range(size):
                buffer.add(states[row], guesses[row])
            state, unknowns, index = states[-1], guesses[-1], index + size
            if wanted == chunk:
                note()
    finally:
        buffer.flush()
    return task.statistics(plugin)


class _Integrators:
    """Integrators of some lengths, made when first needed."""

    def __init__(self, task: Task, plugin: str, options: Mapping[str, float | bool]) -> None:
        self._task, self._plugin, self._options = task, plugin, dict(options)
        self._equations = implicit_equations(task.kernel, task.progress)
        self._constants = self._equations.constants(task.kernel.parameters)
        key = (plugin, task.interval, *self._options.items())
        self._made = task.kernel.made.setdefault(key, {})

    def run(
        self, size: int, start: float, state: Vector, unknowns: Vector
    ) -> tuple[Vector, Vector]:
        """Return states and unknowns at the next ``size`` samples, one row each."""
        if size not in self._made:
            self._task.progress("deriving the integrator", None)
            self._made[size] = self._make(size)
        integrator = self._made[size]
        try:
            given = {"x0": state, "z0": unknowns, "p": [*self._constants, start]}
            result = integrated(integrator, given)
        except RuntimeError:
            raise CallStopped from None
        count_work(integrator.stats(), self._task)
        states, guesses = (np.array(result[key]).T.copy() for key in ("xf", "zf"))
        if not np.isfinite(states).all():
            raise CallStopped
        return states, guesses.reshape(size, unknowns.size)

    def _make(self, size: int) -> Any:
        import casadi

        sym, n = self._equations.symbols.sym, self._equations.n_constants
        elapsed = sym("elapsed")
        dae = elapsed_equations(self._equations, sym("p", n + 1), elapsed) | {"t": elapsed}
        grid = [self._task.interval * k for k in range(1, size + 1)]
        return casadi.integrator(f"chunk_{size}", self._plugin, dae, 0.0, grid, self._options)


def _single(
    integrators: _Integrators, task: Task, index: int, point: tuple[Vector, Vector]
) -> tuple[Vector, Vector]:
    """Integrate one interval of a chunk that failed, to find where it fails."""
    moment = task.time(index)
    try:
        return integrators.run(1, moment, *point)
    except CallStopped:
        raise stopped_between(task, (moment, task.time(index + 1)), *point) from None
