"""Adaptive integration with SciPy's explicit pairs on the kernel's rates."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.solve.engine import Vector
from vehicledyn.solve.kernel import Kernel
from vehicledyn.solve.task import SampleBuffer, Statistics, Task


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

    buffer = SampleBuffer(task, task.state, task.unknowns)
    rates = _Rates(task)
    sizes: list[float] = []
    try:
        if task.n_intervals:
            rates.check_start()
            solver = getattr(scipy.integrate, scheme)(
                rates,
                task.start,
                task.state,
                task.time(task.n_intervals),
                rtol=relative_tolerance,
                atol=absolute_tolerance,
            )
            while buffer.next_index <= task.n_intervals:
                _advance(solver, rates, task)
                sizes.append(solver.step_size)
                _take_samples(solver, rates, task, buffer)
    finally:
        buffer.flush()
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
