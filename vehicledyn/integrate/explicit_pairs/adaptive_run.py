"""Adaptive integration with explicit pairs on the kernel's rates."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.events import ConsistentPoint
from vehicledyn.integrate.explicit_pairs.dop853 import Dop853, StepTolerances
from vehicledyn.integrate.explicit_pairs.embedded_pair import EmbeddedPair
from vehicledyn.integrate.task import SampleBuffer, Statistics, Task
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.kernel import Kernel

_STALLED, _CRAWL = 100, 1e-3
"""Steps that must not together be shorter than this part of the longest."""
_REMEDY = "; make an impact an event, soften the contact, or take an implicit solver"
_HOPELESS, _MOST_STEPS = 1000, 1e9
"""Steps after which the rest of the run must not need more than so many at their mean size."""
_WAYPOINTS = 8
"""Parts in which the unknowns are followed while too little of the past is known."""
_PAST = 4
"""Ends of steps that the unknowns are extrapolated from."""


def run_explicit(
    task: Task,
    name: str,
    scheme: str | EmbeddedPair,
    *,
    relative_tolerance: float,
    absolute_tolerance: float,
) -> Statistics:
    """Integrate a task with an explicit pair: our own DOP853, one of SciPy, or given coefficients.

    Parameters
    ----------
    task
        What to integrate.
    name
        Name of the method for the statistics.
    scheme
        "DOP853", the name of a class in ``scipy.integrate``, or the coefficients of a pair.
    relative_tolerance, absolute_tolerance
        Tolerances of the local error of each state.
    """

    def begin(point: ConsistentPoint) -> Any:
        stop = task.time(task.n_intervals)
        if scheme == "DOP853":
            tolerances = StepTolerances(relative_tolerance, absolute_tolerance)
            return Dop853(rates, point.time, point.state, stop, tolerances=tolerances)
        return _solver_class(scheme)(
            rates,
            point.time,
            point.state,
            stop,
            rtol=relative_tolerance,
            atol=absolute_tolerance,
        )

    buffer = SampleBuffer(task, task.state, task.unknowns)
    rates = _Rates(task)
    sizes: list[float] = []
    last: ConsistentPoint | None = None
    since_event = 0
    try:
        if task.n_intervals:
            rates.check_start()
            solver = begin(ConsistentPoint(task.begin, task.state, task.unknowns))
            while buffer.next_index <= task.n_intervals and not task.watch.ended_by:
                _advance(solver, rates, task)
                sizes.append(solver.step_size)
                if solver.step_size > 0.0:
                    task.count_steps(1, float(solver.step_size))
                if task.each_step is not None:
                    task.each_step(solver.t, solver.y, rates.accepted, float(solver.step_size))
                since_event += 1
                if since_event > _STALLED:
                    _check_advance(task, rates, solver, sizes)
                event = _watch_step(solver, rates, task, buffer) if task.watch.active else None
                if event is None:
                    _take_samples(solver, rates, task, buffer)
                else:
                    last, solver, since_event = event, begin(event), 0
    finally:
        buffer.flush()
    if last is not None and task.watch.ended_by:
        task.deliver_point(last)
    return task.statistics(name)


def _solver_class(scheme: str | EmbeddedPair) -> Any:
    """Return the class of SciPy's solvers for a scheme."""
    if isinstance(scheme, EmbeddedPair):
        return scheme.solver_class()
    import scipy.integrate  # takes a good part of a second, so only where it is needed

    return getattr(scipy.integrate, scheme)


class _Rates:
    """Rates for a trial step; a loop that cannot close there makes the step fail.

    The unknowns are guessed by extrapolation of those at the ends of accepted steps, or in the
    first steps followed from the last end on. Otherwise they would be drawn to a wrong branch
    near a place where two meet, as those of a parallelogram in line.
    """

    def __init__(self, task: Task) -> None:
        self._task = task
        self._past = [(task.begin, task.unknowns.copy())]
        self._end = task.state.copy()
        self.accepted = task.unknowns.copy()
        self.latest = task.unknowns.copy()
        self.trouble = ""

    def accept(self, time: float, state: Vector) -> None:
        """Remember the latest unknowns as those at the end of a step."""
        self.accepted, self._end = self.latest.copy(), state.copy()
        self._past = [*self._past, (time, self.accepted)][-_PAST:]

    def start_anew(self, point: ConsistentPoint) -> None:
        """Forget the past, as the motion has a corner here."""
        self.accepted, self._end = point.unknowns.copy(), point.state.copy()
        self._past = [(point.time, self.accepted)]

    def guess(self, time: float, state: Vector) -> Vector:
        """Return a guess of the unknowns at a time and state.

        Raises
        ------
        NumericalError
            If a loop cannot be followed up to there.
        """
        times = [past for past, _ in self._past]
        if len(times) < _PAST:
            return self._followed(time, state)
        guess = np.zeros_like(self.latest)
        for own, unknowns in self._past:
            others = [other for other in times if other != own]
            guess += unknowns * math.prod((time - other) / (own - other) for other in others)
        return guess

    def __call__(self, time: float, state: Vector) -> Vector:
        x = np.ascontiguousarray(state)
        if not np.isfinite(x).all():
            return np.full(x.size, math.nan)
        try:
            self.latest = self.guess(time, x)
            return self._task.kernel.evaluate(time, x, self.latest, self._task.ledger)
        except NumericalError as error:
            self.trouble = str(error)
            self.latest = self.accepted.copy()
            return np.full(x.size, math.nan)

    def _followed(self, time: float, state: Vector) -> Vector:
        """Return the unknowns followed from the last end of a step, along a straight line."""
        begin, unknowns = self._past[-1]
        for part in np.arange(1, _WAYPOINTS) / _WAYPOINTS:
            moment = begin + part * (time - begin)
            between = self._end + part * (state - self._end)
            kernel, ledger = self._task.kernel, self._task.ledger
            unknowns = kernel.count_solve(moment, between, unknowns, ledger)
        return unknowns.copy()

    def check_start(self) -> None:
        """Raise NumericalError if the rates at the start are no finite numbers."""
        rates = self(self._task.begin, self._task.state)
        if not np.isfinite(rates).all():
            where = int(np.flatnonzero(~np.isfinite(rates))[0])
            name = self._task.kernel.equations.states[where].name
            raise NumericalError(
                self.trouble
                or f"the rate of state '{name}' is no finite number at t = {self._task.begin:g} s"
            )


def _advance(solver: Any, rates: _Rates, task: Task) -> None:
    """Take one accepted step."""
    rates.trouble = ""
    solver.step()
    if solver.status == "failed":
        reason = rates.trouble or "the step size became too small"
        raise NumericalError(
            f"integration stopped at t = {solver.t:.9g} s: {reason}; "
            f"state '{steepest_state(task.kernel, solver.t, solver.y, rates.accepted)}' "
            f"changes fastest there{'' if rates.trouble else _REMEDY}"
        )
    # The last rates of a step are those at its end.
    rates.accept(solver.t, solver.y)


def _check_advance(task: Task, rates: _Rates, solver: Any, sizes: list[float]) -> None:
    """Raise NumericalError where many steps together come to almost nothing."""
    if len(sizes) % _HOPELESS == 0:
        _check_prospect(task, solver, sizes)
    if sum(sizes[-_STALLED:]) < _CRAWL * max(sizes):
        raise NumericalError(
            f"integration stopped at t = {solver.t:.9g} s: the last {_STALLED} steps together "
            f"advanced {sum(sizes[-_STALLED:]):.3g} s; "
            f"state '{steepest_state(task.kernel, solver.t, solver.y, rates.accepted)}' "
            f"changes fastest there{_REMEDY}"
        )


def _check_prospect(task: Task, solver: Any, sizes: list[float]) -> None:
    """Raise NumericalError where the rest of the run would need more steps than can be taken."""
    mean = sum(sizes[-_HOPELESS:]) / _HOPELESS
    missing = (task.time(task.n_intervals) - solver.t) / mean
    if missing > _MOST_STEPS:
        raise NumericalError(
            f"integration stopped at t = {solver.t:.9g} s: the last {_HOPELESS} steps were "
            f"{mean:.3g} s long on average, and the rest of the run would need {missing:.1e} of "
            "them; loosen the tolerances, or look for a rate that jumps or shakes there"
        )


def _watch_step(
    solver: Any, rates: _Rates, task: Task, buffer: SampleBuffer
) -> ConsistentPoint | None:
    """Return where the motion starts anew if an event fires in the last step.

    The watched points are looks into the step, as many as the order of the method: steps of high
    order are long.
    """
    dense, begin, watch = solver.dense_output(), solver.t_old, task.watch

    def trial(time: float) -> ConsistentPoint:
        state = np.ascontiguousarray(dense(time))
        guess = rates.guess(time, state)
        return ConsistentPoint(
            time, state, task.kernel.count_solve(time, state, guess, task.ledger)
        )

    for end in np.linspace(solver.t_old, solver.t, solver.order + 1)[1:]:
        point = trial(float(end))
        if watch.fires(point):
            time, point = watch.cross(trial, begin, float(end), 1.0)
            _take_samples_before(time, trial, task, buffer)
            rates.start_anew(point)
            return point
        begin = float(end)
    return None


def _take_samples_before(
    time: float, trial: Callable[[float], ConsistentPoint], task: Task, buffer: SampleBuffer
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
        state = np.ascontiguousarray(dense(moment))
        buffer.add(state, rates.guess(moment, state))


def steepest_state(kernel: Kernel, time: float, state: Vector, unknowns: Vector) -> str:
    """Return the name of the state with the largest rate for its size."""
    rates = kernel.rates(time, state, unknowns)
    measure = np.nan_to_num(np.abs(rates) / (1.0 + np.abs(state)), nan=math.inf)
    return kernel.equations.states[int(np.argmax(measure))].name
