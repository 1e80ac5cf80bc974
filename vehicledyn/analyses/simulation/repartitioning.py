"""Simulate while the partition is watched: choose it anew, or pass singular configurations.

The determinants of the loops' blocks tell at the samples how well the dependent coordinates are
determined. Where one goes to zero there are two cases. If other coordinates would do better, the
run stops at a sample, derives the equations again with the present configuration as the start,
and goes on from the same state. If none would, the configuration itself is singular, and the
run passes it in one step, see :mod:`vehicledyn.analyses.simulation.singularity_crossing`.
"""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.simulation.projected import ProjectedRun
from vehicledyn.analyses.simulation.rederived import derived_at, state_in, values_of
from vehicledyn.analyses.simulation.singularity_crossing import (
    FINE_TOLERANCE,
    TOLERANCE,
    Passage,
    Sample,
)
from vehicledyn.analyses.simulation.singularity_monitor import (
    FINE_LEVERAGE,
    LEVERAGE,
    WIDE_ZONE,
    ZONE,
    Crossing,
    Degrading,
    PivotLog,
)
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.integrate.course import Course
from vehicledyn.integrate.judged_quantities import Judged
from vehicledyn.integrate.simulate import Solver, simulate
from vehicledyn.integrate.task import Happened, Sink, Statistics, joined
from vehicledyn.kernel.kernel import Kernel, Progress
from vehicledyn.multibody.model.system import MOST_ENTANGLED, System

if TYPE_CHECKING:
    from vehicledyn.multibody.loops.partition_monitor import Comparison, PartitionWatch

Vector = NDArray[np.float64]

_GAIN = 0.5
"""A new partition must bring the leverage down to this part."""
_INACCURATE = 10.0 * FINE_LEVERAGE
"""Leverage behind which steps of a fixed size are inaccurate, if other coordinates do better."""
_WELL_REGULAR = 0.02
"""Least singular value of scaled constraints that is far from a singular position [1]."""
_FIRST_SEGMENT = 32
_LOOK, _STEPS_PER_LOOK = 0.02, 10
_WIDE_BLOCK, _STEPS_IF_WIDE = 6, 2
"""Unknowns of a loop above which a partition may degrade within few steps, and steps per look."""
_log = logging.getLogger(__name__)


def simulate_watched(
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
    watch: Callable[[], PartitionWatch] | None = None,
    judged: Judged | None = None,
    course: Course | None = None,
) -> Statistics:
    """Integrate as :func:`~vehicledyn.integrate.simulate.simulate` does, through bad partitions.

    The samples are those of the kernel's own equations throughout: states and unknowns in their
    order, channels by name; a channel that a later partition lacks is not a number. ``happened``
    is told "partition.changed" when the partition changes, and "constraint_method.changed" where
    the run goes on with multipliers since no partition lasts. A passage looks for no events.
    ``watch`` makes the watch of the system when it is needed, if the caller knows a quick way;
    ``judged`` is what the accuracy is judged by, see ``simulate``; ``course`` is as there too, up
    to the first change of the partition.

    Raises
    ------
    InputError
        As for ``simulate``.
    NumericalError
        If the integration cannot go on; a singular configuration is named with its loop and
        coordinate.
    """
    e = kernel.equations
    make_watch = watch or (lambda: _watch_of(system))
    if e.structure.get("constraint_method") == "multipliers":
        beginning = None if course is None else course.beginning
        with_multipliers = ProjectedRun(
            kernel,
            solver,
            start if beginning is None else beginning.time,
            stop,
            interval,
            sink,
            progress,
            happened,
            make_watch,
            None if judged is None else replace(judged, figures=None),
        )
        return with_multipliers.go(
            np.asarray(state, dtype=float),
            np.asarray(unknowns, dtype=float),
            skip=beginning is not None,
        )
    if not e.structure.get("loops") and not e.structure.get("rate_dependent"):
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
    run = _Run(
        system,
        kernel,
        solver,
        start,
        stop,
        interval,
        sink,
        progress,
        happened,
        make_watch,
        judged,
        course,
    )
    return run.go(np.asarray(state, dtype=float), np.asarray(unknowns, dtype=float))


def _watch_of(system: System) -> PartitionWatch:
    from vehicledyn.multibody.loops.partition_monitor import PartitionWatch

    return PartitionWatch.of(system)


@dataclass
class _Run:
    """A run in pieces: from one change or passage to the next."""

    system: System
    kernel: Kernel
    solver: Solver
    start: float
    stop: float
    interval: float
    sink: Sink
    progress: Progress
    happened: Happened
    make_watch: Callable[[], PartitionWatch]
    judged: Judged | None = None
    course: Course | None = None

    def __post_init__(self) -> None:
        self._known: dict[tuple[str, ...], Kernel] = {}
        self._first = self.kernel.equations
        adaptive = getattr(self.solver, "relative_tolerance", None)
        zone = ZONE if adaptive is None else WIDE_ZONE
        self._tolerance = min(TOLERANCE, max(adaptive or TOLERANCE, FINE_TOLERANCE))
        has_step = getattr(self.solver, "step", None) is not None
        self._leverage = FINE_LEVERAGE if has_step else LEVERAGE
        self._log = PivotLog(
            self._pivots, self._forward, self._better_at_look, zone=zone, leverage=self._leverage
        )
        self._changed_at = -np.inf
        self._segment: int | None = None
        self._passed = 0
        self._parts: list[Statistics] = []
        self._forwarded = 0
        self._started = time.perf_counter()
        sizes = (block.stop - block.start for block in self.kernel.equations.blocks)
        is_wide = max(sizes, default=0) > _WIDE_BLOCK
        steps = _STEPS_IF_WIDE if is_wide else _STEPS_PER_LOOK
        self._every = looks_per_interval(self.solver, self.interval, steps)
        self.interval = self.interval / self._every

    def go(self, state: Vector, unknowns: Vector) -> Statistics:
        """Run to the end; whatever stops it, the samples found are handed on."""
        try:
            return self._go(state, unknowns)
        except Degrading as degrading:
            error = self._lasts_no_longer(degrading.sample, degrading.comparison)
            return self._with_multipliers(degrading.sample, error)
        except NumericalError as error:
            return self._with_multipliers(self._log.back_to_sound(), error)
        finally:
            self._log.release()

    def _with_multipliers(self, sample: Sample | None, error: NumericalError) -> Statistics:
        """Go on with multipliers where no partition lasts, but no constraint depends on others.

        Raises the error where that is not so, or leads no further.
        """
        if sample is None or self.system.constraint_method != "auto":
            raise error
        if not self._watch.is_regular(sample.time, values_of(self.kernel, sample)):
            raise error
        self.progress("deriving the equations with multipliers", None)
        try:
            kernel = derived_at(
                self.system, self.kernel, sample, first=self._first, method="multipliers"
            )
        except InputError:
            raise error from None
        state, guess = state_in(kernel, self.kernel, sample)
        self.kernel = kernel.with_parameters(self.kernel.parameters)
        self.happened("constraint_method.changed", sample.time)
        _log.info("t = %.6g s: constraints are treated with multipliers from now on", sample.time)
        run = ProjectedRun(
            self.kernel,
            self.solver,
            sample.time,
            self._end,
            self.interval,
            self._forward_rows,
            self.progress,
            self.happened,
            lambda: self._watch,
        )
        try:
            self._parts.append(run.go(state, guess, skip=True))
        except NumericalError:
            raise error from None
        return self._statistics()

    def _forward_rows(self, times: Vector, x: Vector, z: Vector, y: Vector) -> None:
        rows = zip(times, x, z, y, strict=True)
        self._forward([Sample(float(time), *parts) for time, *parts in rows])

    def _go(self, state: Vector, unknowns: Vector) -> Statistics:
        index, resumed = 0, False
        while True:
            last = self._last(index)
            self._log.begin(skip=resumed)
            try:
                found = self._piece(index, last, state, unknowns)
            except Crossing as crossing:
                index, state, unknowns = self._pass(crossing, index)
            except Degrading as degrading:
                if self._changes_to_multipliers:
                    raise
                index, state, unknowns = self._change_for(degrading)
            except NumericalError as error:
                index, state, unknowns = self._rescue(error, index)
            else:
                self._parts.append(found)
                end = self._log.latest
                if found.ended_by or last is None or self._time(last) >= self._end - 1e-12:
                    self._log.release()
                    return self._statistics()
                index, state, unknowns = last, end.state, end.unknowns
                self._segment = 2 * (self._segment or _FIRST_SEGMENT)
            resumed = True

    @property
    def _end(self) -> float:
        count = np.floor((self.stop - self.start) / self.interval * (1.0 + 1e-12) + 1e-9)
        return self._time(int(count))

    def _time(self, index: int) -> float:
        return self.start + self.interval * index

    def _index(self, time: float) -> int:
        """Return the number of the first sample at or behind a time."""
        return int(np.ceil((time - self.start) / self.interval - 1e-9))

    def _last(self, index: int) -> int | None:
        """Return the last sample of the next piece; None for all that remain."""
        return None if self._segment is None else index + self._segment

    def _piece(self, index: int, last: int | None, state: Vector, unknowns: Vector) -> Statistics:
        stop = self.stop if last is None else min(self.stop, self._time(last))
        return simulate(
            self.kernel,
            self.solver,
            start=self._time(index),
            stop=stop,
            state=state,
            unknowns=unknowns,
            interval=self.interval,
            sink=self._log.take,
            progress=self._tell,
            happened=self.happened,
            judged=self._judged(is_whole=index == 0 and last is None),
            # Behind a change or a passage nothing is noted: a continued run comes to it again.
            course=self.course if index == 0 and last is None else None,
        )

    def _judged(self, *, is_whole: bool) -> Judged | None:
        """Return what a piece is judged by: key figures only where it is the whole run."""
        if self.judged is None:
            return None
        first, now = self._first.channels, self.kernel.equations.channels
        places = {channel.name: k for k, channel in enumerate(now)}
        names = [first[k].name for k in self.judged.channels]
        channels = [places[name] for name in names if name in places]
        return replace(
            self.judged, channels=channels, figures=self.judged.figures if is_whole else None
        )

    def _tell(self, what: str, part: float | None) -> None:
        done = self._log.latest_time
        if part is not None and done is not None and self.stop > self.start:
            part = (done - self.start) / (self.stop - self.start)
        self.progress(what, part)

    # -- passing -----------------------------------------------------------------------------

    def _pass(self, crossing: Crossing, index: int) -> tuple[int, Vector, Vector]:
        """Step over a singular configuration; return where the run goes on.

        Where other coordinates do better on the way to it, they are taken instead.
        """
        earlier = self._first_better(crossing.before, crossing.seen)
        if earlier is not None:
            self._log.release()
            return self._change_between(*earlier)
        begin = crossing.begin
        passage = Passage(self.kernel, begin, self._tolerance)
        try:
            behind = passage.go(crossing=crossing.blocks, until=crossing.until)
            first = self._index(begin.time) + 1
            last = max(first, min(self._index(behind), self._index(self._end)))
            if self._time(last) > behind:
                passage.advance(self._time(last))
            samples = [passage.sample(self._time(k)) for k in range(first, last + 1)]
        except NumericalError as error:
            stuck = self._stuck(crossing, error)
            try:
                changed = self._change_before(crossing)
            except NumericalError:
                changed = None
            if changed is None:
                raise NumericalError(stuck) from None
            return changed
        self._log.restart(begin, samples)
        count = last - self._passed
        self._segment, self._passed = max(_FIRST_SEGMENT, count // 3), last
        return last, samples[-1].state, samples[-1].unknowns

    def _change_before(self, crossing: Crossing) -> tuple[int, Vector, Vector] | None:
        """Change the partition between samples, where nearer to the place another is better.

        That is so where a coordinate turns back at a dead point within few samples.
        """
        begin = crossing.begin
        passage = Passage(self.kernel, begin, self._tolerance)
        for near in passage.approach(crossing.blocks):
            found = self._better(near, LEVERAGE)
            if found is None:
                continue
            first, last = self._index(begin.time) + 1, self._index(near.time)
            samples = [passage.sample(self._time(k)) for k in range(first, last)]
            if samples:
                self._log.restart(begin, samples)
            index, here = self._changed(near, found)
            rest = Passage(self.kernel, here, self._tolerance)
            rest.advance(self._time(index))
            end = rest.sample(self._time(index))
            self._log.restart(here, [end])
            return index, end.state, end.unknowns
        return None

    def _changed(self, near: Sample, found: Comparison) -> tuple[int, Sample]:
        """Change the partition at a sample; return it in the new one, and the index behind it."""
        index, state, unknowns = self._change(near, found)
        outputs = self.kernel.outputs(near.time, state, unknowns)
        return index, Sample(near.time, state, unknowns, outputs)

    def _stuck(self, crossing: Crossing, error: NumericalError) -> str:
        blocks = [self.kernel.equations.blocks[k] for k in crossing.blocks]
        loops = ", ".join(f"'{block.name}'" for block in blocks)
        names = self.kernel.equations.unknowns
        inside = [f"'{names[k].name}'" for b in blocks for k in range(b.start, b.stop)]
        return (
            f"the loop {loops} becomes singular soon after t = {crossing.begin.time:.9g} s and "
            f"no longer determines {', '.join(inside)}, nor would other coordinates do better; "
            f"the motion cannot be continued there ({error})"
        )

    # -- changing the partition --------------------------------------------------------------

    def _change_for(self, degrading: Degrading) -> tuple[int, Vector, Vector]:
        """Change the partition at the first step at which another is clearly better.

        The steps since the look before are taken once more, as the last of them are inaccurate.
        """
        sample = degrading.sample
        earlier = self._first_better(degrading.before, sample.time)
        if earlier is not None:
            return self._change_between(*earlier)
        self._refuse_late(sample, degrading.comparison)
        self._log.accept(sample)
        return self._change(sample, degrading.comparison)

    def _first_better(self, before: Sample | None, stop: float) -> tuple[Sample, Comparison] | None:
        """Return the first step between two looks at which other coordinates do clearly better."""
        step = getattr(self.solver, "step", None)
        if before is None or step is None:
            return None
        rows: list[Sample] = []
        count = max(1, round((stop - before.time) / step))
        with suppress(NumericalError):
            self._simulate_to(stop, before, (stop - before.time) / count, rows)
        for near in rows[1:count]:
            found = self._better(near, self._leverage)
            if found is not None and near.time > self._changed_at:
                self._refuse_late(near, found)
                return near, found
        return None

    def _refuse_late(self, sample: Sample, found: Comparison) -> None:
        """Raise NumericalError where a step of fixed size has come too near to a bad partition."""
        step = getattr(self.solver, "step", None)
        if step is not None and found.leverage > _INACCURATE:
            raise NumericalError(
                f"the partition degrades within a step of {step:.3g} s at t = {sample.time:.9g} s: "
                f"'{found.worst}' moves {found.leverage:.0f} times as fast as the coordinates that "
                "determine it, and steps before are inaccurate; take a smaller step or "
                "'constraint_method: multipliers'"
            )

    def _change_between(self, near: Sample, found: Comparison) -> tuple[int, Vector, Vector]:
        """Change the partition at a step between two looks; go on at the second."""
        index, here = self._changed(near, found)
        rows: list[Sample] = []
        self._simulate_to(self._time(index), here, self._time(index) - here.time, rows)
        self._log.restart(here, rows[-1:])
        return index, rows[-1].state, rows[-1].unknowns

    def _simulate_to(self, stop: float, begin: Sample, interval: float, rows: list[Sample]) -> None:
        """Integrate from a sample with nothing watched, and keep the samples."""
        simulate(
            self.kernel,
            self.solver,
            start=begin.time,
            stop=stop,
            state=begin.state,
            unknowns=begin.unknowns,
            interval=interval,
            sink=lambda *parts: rows.extend(
                Sample(float(time), *map(np.array, row)) for time, *row in zip(*parts, strict=True)
            ),
            progress=lambda what, part: None,
            happened=lambda name, time: None,
        )

    @cached_property
    def _watch(self) -> PartitionWatch:
        return self.make_watch()

    @property
    def _dependent(self) -> list[str]:
        structure = self.kernel.equations.structure
        return [*structure["dependent"], *structure["rate_dependent"]]

    def _pivots(self, samples: Sequence[Sample]) -> Vector:
        """Return the determinants of the loops, and of the rates where they have their own."""
        parts = [[getattr(s, name) for s in samples] for name in ("time", "state", "unknowns")]
        values = self.kernel.pivots(*parts)
        if not self.kernel.equations.structure["rate_dependent"]:
            return values
        rates = [
            self._watch.pivot(s.time, values_of(self.kernel, s), self._dependent) for s in samples
        ]
        return np.column_stack([values, rates])

    def _better_at_look(self, sample: Sample, limit: float) -> Comparison | None:
        """Return the same at a look, but none at a terminal event, behind which nothing follows."""
        return self._better(sample, limit) if self._is_look(sample.time) else None

    def _better(self, sample: Sample, limit: float) -> Comparison | None:
        """Return the comparison with the best partition if that is clearly better.

        It is looked for only where the leverage is above the limit.
        """
        values = values_of(self.kernel, sample)
        leverage = self._watch.leverage(sample.time, values, self._dependent)
        if leverage <= limit:
            return None
        # Near a singular position all partitions are bad; there only a much better one helps.
        is_mild = 0.0 < limit < leverage <= LEVERAGE
        if is_mild and not self._watch.is_regular(sample.time, values, _WELL_REGULAR):
            return None
        found = self._watch.compare(sample.time, values, self._dependent)
        return found if found.best_leverage < _GAIN * leverage else None

    def _change(self, sample: Sample, found: Comparison) -> tuple[int, Vector, Vector]:
        """Derive the equations anew at a sample; return where the run goes on."""
        if sample.time <= self._changed_at:
            raise self._lasts_no_longer(sample, found)
        self._changed_at = sample.time
        if found.best not in self._known:
            self.progress("deriving the equations with other dependent coordinates", None)
            self._known[found.best] = derived_at(
                self.system, self.kernel, sample, first=self._first, method="partitioning"
            )
        new = self._known[found.best].with_parameters(self.kernel.parameters)
        state, guess = state_in(new, self.kernel, sample)
        unknowns = new.solve_unknowns(sample.time, state, guess)
        outputs = new.outputs(sample.time, state, unknowns)
        self.kernel = new
        self._log.change(Sample(sample.time, state, unknowns, outputs))
        _log.info("t = %.6g s: '%s' is no longer dependent", sample.time, found.worst)
        self.happened("partition.changed", sample.time)
        return self._index(sample.time), state, unknowns

    def _rescue(self, error: NumericalError, index: int) -> tuple[int, Vector, Vector]:
        """Change the partition or pass, if that is why the run has failed; else raise again."""
        sample = self._log.latest_or_none
        if sample is None:
            raise error
        found = self._better(sample, 0.0)
        if found is not None and sample.time > self._changed_at:
            return self._change(self._log.release_to(sample), found)
        crossing = self._log.approaching(2.0 * self.interval)
        if crossing is None:
            raise error
        return self._pass(crossing, index)

    @property
    def _changes_to_multipliers(self) -> bool:
        """Whether a bad partition is left for multipliers, as many constraints are coupled."""
        return (
            self.system.constraint_method == "auto" and self._watch.most_entangled > MOST_ENTANGLED
        )

    def _lasts_no_longer(self, sample: Sample, found: Comparison) -> NumericalError:
        return NumericalError(
            f"no partition of the coordinates lasts at t = {sample.time:.9g} s; "
            f"'{found.worst}' is not determined"
        )

    # -- samples -----------------------------------------------------------------------------

    def _forward(self, samples: list[Sample]) -> None:
        """Hand on the samples that are asked for, in the order of the first equations."""
        samples = [sample for sample in samples if self._is_wanted(sample.time)]
        self._forwarded += len(samples)
        if not samples:
            return
        e, first = self.kernel.equations, self._first
        times = np.array([s.time for s in samples])
        parts = [np.array([getattr(s, k) for s in samples]) for k in ("state", "unknowns")]
        outputs = np.array([s.outputs for s in samples])
        if e is not first:
            columns = {c.name: k for k, c in enumerate(e.channels)}
            columns.update({u.name: k + len(columns) for k, u in enumerate(e.unknowns)})
            table = np.hstack([outputs, parts[1], np.full((len(samples), 1), np.nan)])
            pick: Callable[[Any], list[int]] = lambda items: [  # noqa: E731
                columns.get(item.name, -1) for item in items
            ]
            parts = [table[:, pick(first.states)], table[:, pick(first.unknowns)]]
            outputs = table[:, pick(first.channels)]
        self.sink(times, parts[0], parts[1], outputs)

    def _is_wanted(self, time: float) -> bool:
        """Return whether a sample is one of those asked for, or that of a terminal event."""
        number = round((time - self.start) / self.interval)
        return not self._is_look(time) or number % self._every == 0

    def _is_look(self, time: float) -> bool:
        number = (time - self.start) / self.interval
        return abs(number - round(number)) <= 1e-6

    def _statistics(self) -> Statistics:
        """Return the statistics of all pieces together, their time with that between them."""
        seconds = time.perf_counter() - self._started
        return replace(joined(self._parts), samples=self._forwarded, wall_seconds=seconds)


def looks_per_interval(solver: Solver, interval: float, steps: int = _STEPS_PER_LOOK) -> int:
    """Return how often the pivots are looked at in a sampling interval.

    With a fixed step that is about every so many ``steps``, a divisor of their number; else at
    least every 20 ms.
    """
    step = getattr(solver, "step", None)
    if step is None:
        return max(1, math.ceil(interval / _LOOK))
    count = max(1, round(interval / step))
    return next(k for k in range(max(1, count // steps), 0, -1) if count % k == 0)
