"""Runs of Newmark's family whose accuracy is watched as that of other methods with a fixed step."""

from __future__ import annotations

from typing import Any

from vehicledyn.integrate.accuracy.monitored_run import MethodAndStep, Rerun
from vehicledyn.integrate.accuracy.windows import StepGrid, WindowStart
from vehicledyn.integrate.fixed_step import steps_per_interval, watch_of
from vehicledyn.integrate.newmark.family import run_newmark
from vehicledyn.integrate.newmark.weights import Constraints, Weights
from vehicledyn.integrate.simulate import simulate
from vehicledyn.integrate.task import Sink, Statistics, Task
from vehicledyn.kernel.engine import Method


def monitored_method(
    weights: Weights, constraints: Constraints, tolerance: float | None
) -> int | None:
    """Return the method as the watch knows it, None where steps follow a tolerance."""
    if tolerance is not None:
        return None
    family = Method.IMPLICIT if constraints == "reduced" else Method.CONSTRAINED
    return family + weights.order


def run_monitored(task: Task, name: str, solver: Any, weights: Weights) -> Statistics:
    """Integrate a task with a method of the family, and judge how accurate it was.

    Parameters
    ----------
    task
        What to integrate.
    name
        Name of the method for the statistics.
    solver
        Settings of the method.
    weights
        Its weights.

    Raises
    ------
    NumericalError
        If the run cannot go on, or has diverged.
    """
    watch, more = None, {"constraints": solver.constraints, "velocities": solver.velocities}
    if task.watched and solver.monitored_method is not None:
        per_interval = steps_per_interval(solver.step, task.interval)
        times = task.start, task.interval, per_interval, task.n_intervals
        watch = watch_of(task, StepGrid(solver.monitored_method, *times, solver), rerun_of(solver))
    found = run_newmark(task, name, weights, solver.step, tolerance=solver.tolerance, **more)
    if watch is None:
        return found
    accuracy = watch.verdict(ended_early=bool(found.ended_by))
    return task.statistics(name, accuracy=accuracy)


def rerun_of(solver: Any) -> Rerun:
    """Return what takes a part of a run again with other steps."""

    def taken_again(
        place: WindowStart, interval: float, count: int, way: MethodAndStep, sink: Sink
    ) -> Statistics:
        return simulate(
            place.kernel,
            solver.model_copy(update={"step": way.step}),
            start=place.time,
            stop=place.time + count * interval,
            state=place.state,
            unknowns=place.unknowns,
            interval=interval,
            sink=sink,
            watched=False,
        )

    return taken_again
