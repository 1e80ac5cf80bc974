"""Simulate while the partition of coordinates is watched, and the accuracy of the whole run."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.projection import projected
from vehicledyn.analyses.simulation.chosen_step import leaves_step
from vehicledyn.analyses.simulation.partitions.partitioned_run import PartitionedRun
from vehicledyn.analyses.simulation.partitions.projected_run import ProjectedRun, projected_plan
from vehicledyn.analyses.simulation.run_plan import RunPlan
from vehicledyn.analyses.simulation.sample_delivery import Delivery
from vehicledyn.integrate.accuracy.monitor import AccuracyMonitor
from vehicledyn.integrate.accuracy.monitored_run import MethodAndStep
from vehicledyn.integrate.accuracy.proposed_step import proposed_step
from vehicledyn.integrate.accuracy.windows import StepGrid, WindowStart
from vehicledyn.integrate.course import RunHistory
from vehicledyn.integrate.fixed_step import FixedSteps, steps_per_interval
from vehicledyn.integrate.judged_quantities import Judged
from vehicledyn.integrate.simulate import Solver, simulate
from vehicledyn.integrate.task import Happened, Sink, Statistics
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.make_kernel import Progress
from vehicledyn.multibody.model.system import System
from vehicledyn.symbolic.equations import Equations

if TYPE_CHECKING:
    from vehicledyn.multibody.loops.partition_monitor import PartitionMonitor

Vector = NDArray[np.float64]

_STEPS_PER_LOOK = 10
_WIDE_BLOCK, _STEPS_IF_WIDE = 6, 2
"""Unknowns of a loop above which a partition may degrade within few steps, and steps per look."""


def simulate_monitored(
    system: System,
    kernel: Kernel,
    solver: Solver,
    *,
    start: float,
    stop: float,
    state: Any,
    unknowns: Any,
    interval: float,
    sink: Sink,
    progress: Progress,
    happened: Happened,
    watch: Callable[[], PartitionMonitor] | None = None,
    judged: Judged | None = None,
    course: RunHistory | None = None,
) -> Statistics:
    """Integrate as :func:`~vehicledyn.integrate.simulate.simulate` does, through bad partitions.

    The samples are those of the kernel's own equations throughout: states and unknowns in their
    order, channels by name; a channel that a later partition lacks is not a number. ``happened``
    is given "partition.changed" when the partition changes, and "constraint_method.changed" where
    the run goes on with multipliers since no partition lasts. A passage looks for no events.
    ``watch`` makes the watch of the system when it is needed, if the caller knows a quick way;
    ``judged`` is what the accuracy of the whole run is judged by, see ``simulate``; ``course`` is
    as there too, up to the first change of the partition.

    Raises
    ------
    InputError
        As for ``simulate``.
    NumericalError
        If the integration cannot go on; a singular configuration is named with its loop and
        coordinate.
    """
    if not may_change(kernel.equations):
        return simulate(
            kernel,
            solver,
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
        )
    begun = time.perf_counter()
    given = np.asarray(state, dtype=float), np.asarray(unknowns, dtype=float)
    is_new = course is None or course.beginning is None
    if is_new and kernel.equations.structure.get("constraint_method") == "multipliers":
        given = projected(kernel, given[0], kernel.outputs(start, *given)), given[1]
    if leaves_step(solver):
        method: Any = solver
        point = (start, given[0], given[1].copy())
        step = proposed_step(kernel, method.fixed_method, point, interval)
        solver = method.model_copy(update={"step": step})
    pieces = _Pieces(system, kernel.equations, watch or (lambda: _watch_of(system)))
    plan = RunPlan(solver, start, stop, interval, 1, _nowhere, progress, happened)
    accuracy = pieces.accuracy_watch(plan, judged)
    if accuracy is not None:
        accuracy.take_past(kernel, course)
        plan = replace(plan, hint=accuracy.hint)
    delivery = Delivery(kernel.equations, sink, accuracy)
    found = pieces.run(kernel, replace(plan, sink=delivery.take), *given, course=course)
    if accuracy is not None:
        verdict = accuracy.verdict(ended_early=bool(found.ended_by))
        found = replace(found, accuracy=verdict, wall_seconds=time.perf_counter() - begun)
    return found


@dataclass
class _Pieces:
    """Runs in pieces of one system, the second ones with the partitions found in the first."""

    system: System
    first: Equations
    make_watch: Callable[[], PartitionMonitor]
    known: dict[tuple[str, ...], Kernel] = field(default_factory=dict)
    solver: Any = None

    def accuracy_watch(self, plan: RunPlan, judged: Judged | None) -> AccuracyMonitor | None:
        """Return a watch of a whole run; None for methods with step-size control."""
        solver: Any = plan.solver
        if plan.step is None:
            return None
        per_interval = steps_per_interval(plan.step, plan.interval)
        grid = StepGrid.of(solver, plan.start, plan.interval, per_interval, plan.n_looks)
        if grid is None:
            return None
        self.solver = grid.solver
        return AccuracyMonitor(self.first, grid, judged or Judged.usual(self.first), self._again)

    def run(
        self,
        kernel: Kernel,
        plan: RunPlan,
        state: Vector,
        unknowns: Vector,
        *,
        course: RunHistory | None = None,
    ) -> Statistics:
        """Run to the end, through changes of the partition."""
        if kernel.equations.structure.get("constraint_method") == "multipliers":
            beginning = None if course is None else course.beginning
            projected = ProjectedRun(kernel, projected_plan(plan), self.make_watch, course)
            if beginning is not None and beginning.history is not None:
                return projected.go_on(beginning.history, len(state), len(unknowns))
            return projected.go(state, unknowns, skip=beginning is not None)
        plan = plan.looked_at(steps=steps_per_look(kernel.equations))
        run = PartitionedRun(
            self.system, kernel, self.first, plan, self.make_watch, self.known, course
        )
        return run.go(state, unknowns)

    def _again(
        self, place: WindowStart, interval: float, count: int, way: MethodAndStep, sink: Sink
    ) -> Statistics:
        """Take a part of the run again, see ``Rerun``."""
        stop = place.time + count * interval
        delivery = Delivery(self.first, sink)
        solver: Solver = FixedSteps(way.method, way.step)
        if self.solver is not None:
            solver = self.solver.model_copy(update={"step": way.step})
        plan = RunPlan(solver, place.time, stop, interval, 1, delivery.take, _silent, _silent)
        return self.run(place.kernel, plan, place.state.copy(), place.unknowns.copy())


def may_change(equations: Equations) -> bool:
    """Return whether a run may need other coordinates, or projection, on the way."""
    known = equations.structure
    has_multipliers = known.get("constraint_method") == "multipliers"
    return bool(has_multipliers or known.get("loops") or known.get("rate_dependent"))


def steps_per_look(equations: Equations) -> int:
    """Return about how many fixed steps a run takes between two looks at its partition."""
    sizes = (block.stop - block.start for block in equations.blocks)
    return _STEPS_IF_WIDE if max(sizes, default=0) > _WIDE_BLOCK else _STEPS_PER_LOOK


def _watch_of(system: System) -> PartitionMonitor:
    from vehicledyn.multibody.loops.partition_monitor import PartitionMonitor

    return PartitionMonitor.of(system)


def _nowhere(*_: object) -> None:
    """Take no samples."""


def _silent(*_: object) -> None:
    """Report nothing."""
