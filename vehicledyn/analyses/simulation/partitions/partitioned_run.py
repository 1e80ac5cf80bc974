"""A run with dependent coordinates, in pieces: from one change of partition or passage to the next.

The determinants of the loops' blocks show at the samples how well the dependent coordinates are
determined. Where one goes to zero there are two cases. If other coordinates would do better, the
run stops at a sample, derives the equations again with the present configuration as the start,
and goes on from the same state. If none would, the configuration itself is singular, and the
run passes it in one step, see
:mod:`vehicledyn.analyses.simulation.partitions.singularity_crossing`.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.simulation.partitions.dead_points import DeadPoints
from vehicledyn.analyses.simulation.partitions.interruptions import (
    Crossing,
    Degrading,
    Misled,
    Weakened,
)
from vehicledyn.analyses.simulation.partitions.partition_changes import (
    PartitionChanges,
    RestartPoint,
    lasts_no_longer,
)
from vehicledyn.analyses.simulation.partitions.projected_run import ProjectedRun, projected_plan
from vehicledyn.analyses.simulation.partitions.rederived import (
    Origin,
    derived_from,
    state_in,
    values_of,
)
from vehicledyn.analyses.simulation.partitions.run_notes import RunNotes, Standing
from vehicledyn.analyses.simulation.partitions.singularity_crossing import Sample
from vehicledyn.analyses.simulation.partitions.singularity_monitor import (
    WIDE_ZONE,
    ZONE,
    PivotLog,
)
from vehicledyn.analyses.simulation.partitions.singularity_passing import SingularityPassing
from vehicledyn.analyses.simulation.run_plan import PieceStart, RunPlan
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.integrate.accuracy.divergence import DivergenceError
from vehicledyn.integrate.course import Beginning, RunHistory
from vehicledyn.integrate.task import Statistics, joined
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.multibody.model.system import System
from vehicledyn.symbolic.equations import Equations

if TYPE_CHECKING:
    from vehicledyn.multibody.loops.partition_monitor import PartitionMonitor

Vector = NDArray[np.float64]

_FIRST_SEGMENT = 32
_log = logging.getLogger(__name__)


@dataclass
class PartitionedRun:
    """A run of a system with loops; ``first`` are the equations that it began with.

    ``known`` holds the kernels of other partitions that have been derived.
    """

    system: System
    kernel: Kernel
    first: Equations
    plan: RunPlan
    make_watch: Callable[[], PartitionMonitor]
    known: dict[tuple[str, ...], Kernel]
    course: RunHistory | None = None
    _parts: list[Statistics] = field(default_factory=list, init=False)
    _segment: int | None = field(default=None, init=False)
    _delivered: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        """Prepare to watch the partition and to change it."""
        self._changes = PartitionChanges(
            self.system,
            self.kernel,
            self.first,
            self.plan,
            self.make_watch,
            self.known,
            self._parts,
        )
        self._dead_points = DeadPoints(self._changes)
        self._passing = SingularityPassing(self._changes, self._dead_points)
        is_adaptive = getattr(self.plan.solver, "relative_tolerance", None) is not None
        self._log = self._changes.log = PivotLog(
            self._changes.pivots,
            self._forward,
            self._changes.better_at_look,
            self._changes.pivot_rates,
            self._dead_points.motion_between,
            zone=WIDE_ZONE if is_adaptive else ZONE,
            leverage=self._changes.leverage,
        )
        self._beginning: Beginning | None = None
        self._origin: Origin | None = None
        self._notes = None
        if self.course is not None:
            self._notes = RunNotes(self._changes, self._log, self.course)
        self._started = time.perf_counter()

    @property
    def kernel_in_use(self) -> Kernel:
        """The kernel of the present partition."""
        return self._changes.kernel

    @property
    def has_passed(self) -> bool:
        """Whether a singular configuration has been passed, by steps of another kind."""
        return self._passing.passed > 0 or self._dead_points.replaced > 0

    def go(self, state: Vector, unknowns: Vector) -> Statistics:
        """Run to the end; whatever stops it, the samples found are handed on.

        Raises
        ------
        NumericalError
            If the integration cannot go on.
        """
        try:
            self._begin(state, unknowns)
        except Degrading as degrading:
            error = lasts_no_longer(degrading.sample, degrading.comparison)
            self._go_on_with_multipliers(degrading.sample, error)
        except DivergenceError:
            raise
        except NumericalError as error:
            self._go_on_with_multipliers(self._log.back_to_sound(), error)
        finally:
            self._log.release()
        seconds = time.perf_counter() - self._started
        return replace(joined(self._parts), samples=self._delivered, wall_seconds=seconds)

    def _begin(self, state: Vector, unknowns: Vector) -> None:
        """Run from the start, or go on from what was noted."""
        begun = None if self.course is None else self.course.beginning
        if self._notes is None or begun is None or begun.history is None:
            self._beginning = begun
            self._go(RestartPoint(0, state, unknowns))
            return
        known = self._notes.recall(begun, begun.history)
        self._beginning = known.beginning
        if known.origin is not None:
            self._origin = known.origin
            self._changes.kernel = self._multipliers_from(known.origin)
            self._project(known.start)
        elif known.standing is not None and known.sample is not None:
            self._segment = known.standing.segment
            self._passing.passed = known.standing.passed
            self._go(RestartPoint(known.standing.look, known.sample.state, known.sample.unknowns))

    def _go(self, place: RestartPoint) -> None:
        resumed, plan = False, self.plan
        while True:
            last = self._last_look(place)
            self._log.begin(skip=resumed)
            try:
                found = self._piece(place, last)
            except Crossing as crossing:
                place = self._pass(crossing)
            except Degrading as degrading:
                if self._changes.prefers_multipliers:
                    raise
                if self._ends_with_multipliers(degrading):
                    return
                place = self._dead_points.change_for(degrading)
            except Misled as misled:
                place = self._dead_points.put_right(misled)
            except DivergenceError:
                raise
            except NumericalError as error:
                place = self._rescue(error)
            else:
                end = self._log.latest
                if found.ended_by or last is None or last >= plan.n_looks:
                    self._log.release()
                    return
                place = RestartPoint(last, end.state, end.unknowns)
                if self._segment is not None:
                    self._segment *= 2
                if self._changes.looks_on_trial is not None:
                    self._changes.settle()
            resumed = True

    def _last_look(self, place: RestartPoint) -> int | None:
        """Return the look at which a piece ends, None where that is the end of the run."""
        counts = (self._segment, self._changes.looks_on_trial)
        return min((place.look + count for count in counts if count is not None), default=None)

    def _piece(self, place: RestartPoint, last: int | None) -> Statistics:
        plan, course = self.plan, None
        if self._notes is not None:
            standing = Standing(place.look, self._segment, self._passing.passed)
            course = self._notes.of_piece(standing, self._beginning)
            self._beginning = None
        try:
            return replace(plan, happened=self._note_event).integrate(
                self._changes.kernel,
                PieceStart(plan.time(place.look), place.state, place.unknowns),
                plan.time(plan.n_looks if last is None else min(plan.n_looks, last)),
                sink=self._log.take,
                parts=self._parts,
                progress=lambda what, part: plan.report(what, part, self._log.latest_time),
                course=course,
                each_step=self._at_step,
            )
        except Weakened as weakened:
            raise self._log.met(weakened.blocks, weakened.time) from None

    def _note_event(self, name: str, time: float) -> None:
        """Report an event, and remember when it has happened."""
        self._changes.event_times.append(time)
        self.plan.happened(name, time)

    def _at_step(self, time: float, state: Vector, unknowns: Vector, size: float) -> None:
        """Look at the end of a step of a method that chooses its size."""
        if self._log.wants_step(size):
            outputs = self._changes.kernel.outputs(time, state, unknowns)
            self._log.at_step(Sample(time, state, unknowns, outputs))

    def _pass(self, crossing: Crossing) -> RestartPoint:
        """Pass a singular configuration; in a motion full of them the next piece is short."""
        before = self._passing.passed
        place = self._passing.go(crossing)
        if self._passing.passed > before:
            self._segment = max(_FIRST_SEGMENT, (self._passing.passed - before) // 3)
        return place

    def _rescue(self, error: NumericalError) -> RestartPoint:
        """Change the partition or pass, if that is why the run has failed; else raise again."""
        sample = self._log.latest_or_none
        if sample is None:
            raise error
        found = self._changes.better(sample, 0.0)
        if found is not None and sample.time > self._changes.changed_at:
            return self._changes.change(self._log.release_to(sample), found)
        crossing = self._log.approaching(2.0 * self.plan.interval)
        if crossing is None:
            raise error
        return self._pass(crossing)

    def _ends_with_multipliers(self, degrading: Degrading) -> bool:
        """Run to the end with multipliers where no partition lasts long; return whether it did."""
        sample = degrading.before or degrading.sample
        if not self._changes.never_lasts(sample.time):
            return False
        kernel = self._multiplier_kernel(sample)
        if kernel is None:
            return False
        self._log.release()
        self._finish(kernel, sample)
        return True

    def _go_on_with_multipliers(self, sample: Sample | None, error: NumericalError) -> None:
        """Go on with multipliers where no partition lasts, but no constraint depends on others.

        Raises the error where that is not so, or leads no further.
        """
        kernel = None if sample is None else self._multiplier_kernel(sample)
        if sample is None or kernel is None:
            raise error
        try:
            self._finish(kernel, sample)
        except DivergenceError:
            raise
        except NumericalError:
            raise error from None

    def _multiplier_kernel(self, sample: Sample) -> Kernel | None:
        """Return the equations with multipliers, if they are allowed and regular at a sample."""
        changes = self._changes
        if self.system.constraint_method != "auto":
            return None
        if not changes.watch.is_regular(sample.time, values_of(changes.kernel, sample)):
            return None
        self._origin = changes.origin(sample, interpreted=not changes.compiles)
        try:
            return self._multipliers_from(self._origin)
        except InputError:
            return None

    def _multipliers_from(self, origin: Origin) -> Kernel:
        """Return the equations with multipliers as derived at an origin."""
        self.plan.progress("deriving the equations with multipliers", None)
        parameters = self._changes.kernel.parameters
        kernel = derived_from(origin, self.system, parameters, self.first, "multipliers")
        return kernel.with_parameters(parameters)

    def _finish(self, kernel: Kernel, sample: Sample) -> None:
        """Run from a sample to the end with multipliers."""
        changes = self._changes
        state, guess = state_in(kernel, changes.kernel, sample)
        changes.kernel = kernel
        self.plan.happened("constraint_method.changed", sample.time)
        _log.info("t = %.6g s: constraints are treated with multipliers from now on", sample.time)
        begin = self._at_look(PieceStart(sample.time, state, guess))
        self._project(begin.time, begin)

    def _project(self, start: float, begin: PieceStart | None = None) -> None:
        """Run with multipliers from a look at a start [s], or go on from what was noted."""
        changes, beginning, course = self._changes, self._beginning, None
        if self._notes is not None and self._origin is not None:
            course = self._notes.of_multipliers(start, self._origin, beginning)
        plan = replace(self.plan, start=start, stop=self.plan.end, every=1, sink=self._hand_on)
        run = ProjectedRun(changes.kernel, projected_plan(plan), lambda: changes.watch, course)
        e = changes.kernel.equations
        if begin is not None:
            found = run.go(begin.state, begin.unknowns, skip=True)
        elif beginning is not None and beginning.history is not None:
            found = run.go_on(beginning.history, len(e.states), len(e.unknowns))
        self._parts.append(found)

    def _at_look(self, begin: PieceStart) -> PieceStart:
        """Run with multipliers from a place between two looks to the second, and hand it on."""
        plan, kernel = self.plan, self._changes.kernel
        if plan.is_look(begin.time):
            return begin
        stop = plan.time(plan.index(begin.time))
        rows: list[list[Vector]] = []
        plan.follow(
            kernel,
            begin,
            stop,
            count=1,
            parts=self._parts,
            sink=lambda *parts: rows.append([part[-1:] for part in parts]),
        )
        _, states, unknowns, outputs = rows[-1]
        self._hand_on(kernel, np.array([stop]), states, unknowns, outputs)
        return PieceStart(stop, states[0], unknowns[0])

    def _forward(self, samples: list[Sample]) -> None:
        """Hand samples on, which are given in order."""
        if not samples:
            return
        times = np.array([s.time for s in samples])
        states, unknowns, outputs = (
            np.array([getattr(s, key) for s in samples]) for key in ("state", "unknowns", "outputs")
        )
        self._hand_on(self._changes.kernel, times, states, unknowns, outputs)

    def _hand_on(self, kernel: Kernel, times: Vector, x: Vector, z: Vector, y: Vector) -> None:
        """Hand on those samples that are asked for."""
        wanted = self.plan.is_wanted(times)
        if wanted.any():
            self._delivered += int(wanted.sum())
            self.plan.sink(kernel, times[wanted], x[wanted], z[wanted], y[wanted])
