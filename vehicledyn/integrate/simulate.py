"""Integrate a kernel over time with any method, sampling at equal intervals."""

from __future__ import annotations

import math
from typing import Any, Protocol

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.integrate.course import MethodState, RunHistory
from vehicledyn.integrate.judged_quantities import Judged
from vehicledyn.integrate.task import EachStep, Happened, Sink, Statistics, Task
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.make_kernel import Progress


class Solver(Protocol):
    """Settings of a method that know how to integrate; see :mod:`vehicledyn.integrate.methods`."""

    def integrate(self, task: Task) -> Statistics:
        """Integrate from the first to the last sample, delivering all of them."""


def simulate(
    kernel: Kernel,
    solver: Solver,
    *,
    start: float,
    stop: float,
    state: Any,
    unknowns: Any,
    interval: float,
    sink: Sink,
    progress: Progress | None = None,
    happened: Happened | None = None,
    judged: Judged | None = None,
    course: RunHistory | None = None,
    watched: bool = True,
) -> Statistics:
    """Integrate from ``start`` to ``stop`` and hand samples to a sink.

    Parameters
    ----------
    kernel
        The model with its parameters set.
    solver
        Settings of a method, one of the family "solver".
    start, stop
        First and last time [s]; the last sample is the last multiple of the interval.
    state
        States at the start, shape (n_states,).
    unknowns
        Guess of the algebraic unknowns at the start, shape (n_unknowns,).
    interval
        Time between samples [s].
    sink
        Called with times, states, unknowns and outputs as they are found, also those found
        before an error or an interrupt.
    progress
        Called with the part done.
    happened
        Called with name and time [s] of each event when it happens. A terminal event ends the
        integration, with a last sample at its time; a sample at the time of an event shows
        the state after its reset.
    judged
        What the accuracy of a run with a fixed step is judged by; all channels if left out.
    course
        Notes what the run could be continued with. A continued run has the same start and stop;
        its state and unknowns are those at its beginning, and it delivers what follows.
    watched
        Whether the accuracy of a run with a fixed step is judged.

    Raises
    ------
    InputError
        If the times make no sense, or the step of a method does not divide the interval.
    NumericalError
        If the integration cannot go on; all good samples have gone to the sink.
    """
    task = make_task(
        kernel,
        start=start,
        stop=stop,
        state=state,
        unknowns=unknowns,
        interval=interval,
        sink=sink,
        progress=progress,
        happened=happened,
        judged=judged,
        course=course,
        watched=watched,
    )
    return solver.integrate(task)


def make_task(
    kernel: Kernel,
    *,
    start: float,
    stop: float,
    state: Any,
    unknowns: Any,
    interval: float,
    sink: Sink,
    progress: Progress | None = None,
    happened: Happened | None = None,
    judged: Judged | None = None,
    course: RunHistory | None = None,
    watched: bool = True,
    each_step: EachStep | None = None,
    carried: MethodState | None = None,
) -> Task:
    """Return what :func:`simulate` integrates, which counts its steps as they are taken.

    Parameters and errors are those of ``simulate``.
    """
    for name, value in (("start", start), ("stop", stop), ("interval", interval)):
        if not math.isfinite(value):
            raise InputError(f"the {name} of a simulation must be a finite time, not {value}")
    if interval <= 0.0:
        raise InputError(f"the sampling interval must be positive, not {interval:g} s")
    if stop < start:
        raise InputError(f"the simulation stops at {stop:g} s, before its start at {start:g} s")
    n_intervals = math.floor((stop - start) / interval * (1.0 + 1e-12) + 1e-9)
    is_continued = course is not None and course.beginning is not None
    # Solving what was solved would move the last digits.
    known = np.array(unknowns, dtype=float)
    consistent = known if is_continued else kernel.solve_unknowns(start, state, unknowns)
    return Task(
        kernel=kernel,
        start=start,
        interval=interval,
        n_intervals=n_intervals,
        state=kernel.checked_state(state),
        unknowns=consistent,
        sink=sink,
        progress=progress or _silent,
        happened=happened or _tell_nobody,
        judged=judged,
        course=course,
        watched=watched,
        each_step=each_step,
        carried=carried,
    )


def _silent(what: str, part: float | None) -> None:
    """Show nothing."""


def _tell_nobody(name: str, time: float) -> None:
    """Let an event pass unnoticed."""
