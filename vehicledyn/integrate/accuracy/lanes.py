"""The windows of cases that run side by side, in which their accuracy is watched."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from vehicledyn.integrate.accuracy.half_step_run import energy_is_off, lost_energy
from vehicledyn.integrate.accuracy.monitor import AccuracyMonitor, Windows, finer_steps, most_bound
from vehicledyn.integrate.accuracy.monitored_run import MethodAndStep, Rerun
from vehicledyn.integrate.accuracy.windows import (
    HALF,
    SPENT,
    UNEVEN,
    WHOLE,
    Pieces,
    StepGrid,
    WindowStart,
    may_be_repeated,
    timed,
    two_ends_apart,
    window_count,
    window_places,
)
from vehicledyn.integrate.cases import Samples
from vehicledyn.integrate.channel_ranges import Ranges
from vehicledyn.integrate.estimated_accuracy import Accuracy
from vehicledyn.integrate.judged_quantities import Judged
from vehicledyn.integrate.lane_run import LaneRun
from vehicledyn.integrate.task import Sink, Statistics
from vehicledyn.kernel.engine import Method, Status, Vector
from vehicledyn.kernel.kernel import Kernel


@dataclass
class LaneMonitor:
    """Takes the windows of a run in lanes, at the samples where a case by itself has them.

    ``channels`` are those judged of the first case; ``kept`` are those of the samples.
    """

    kernel: Kernel
    grid: StepGrid
    channels: list[int]
    kept: list[int]
    differences: list[Vector] = field(default_factory=list)
    halves: list[Vector | None] = field(default_factory=list)
    ends: list[Vector] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Choose the windows."""
        count = window_count(self.kernel, self.grid, by_itself=False)
        self._waiting = window_places(self.grid.n_intervals, count)

    def steps_to_go(self, run: LaneRun) -> int:
        """Return the steps up to the next window."""
        following = self._waiting[0] if self._waiting else self.grid.n_intervals
        return max(1, following * self.grid.per_interval - run.step)

    def look(self, run: LaneRun) -> None:
        """Take a window if one is due."""
        if not self._waiting or run.step != self._waiting[0] * self.grid.per_interval:
            return
        self._waiting.pop(0)
        finer = finer_steps(len(self.differences))
        one, other = (self._ends(run, pieces) for pieces in (WHOLE, finer))
        nothing = np.full(len(self.kernel.equations.channels), np.nan)
        self.differences.append(self._apart(one, other))
        is_uneven = finer is UNEVEN
        self.halves.append(self._apart(one, self._ends(run, HALF)) if is_uneven else None)
        self.ends.append(np.array([nothing if end is None else end for end in one]))

    def _apart(self, one: list[Vector | None], other: list[Vector | None]) -> Vector:
        """Return how far ends of windows lie apart, shape (lanes, n_channels)."""
        apart = [two_ends_apart(*pair) for pair in zip(one, other, strict=True)]
        nothing = np.full(len(self.kernel.equations.channels), np.nan)
        return np.array([(nothing if a is None else a)[self.channels] for a in apart])

    def _ends(self, run: LaneRun, pieces: Pieces) -> list[Vector | None]:
        """Return the channels of each lane at the end of a window, None behind an event."""
        engine, window = run.engine, run
        channels = np.arange(len(self.kernel.equations.channels), dtype=np.intc)
        room = np.full((engine.lanes, 1, len(channels)), np.nan)
        begin = self.grid.start + self.grid.interval * (run.step // self.grid.per_interval)
        fates = np.full(engine.lanes, int(Status.SOLVED))
        for start, span, count in timed(self.grid, begin, pieces):
            window = window.window(start, span, count, channels)
            window.fate.status[:] = Status.SOLVED
            window.advance(count, room)
            fates = np.where(fates == Status.SOLVED, window.fate.status, fates)
        found: list[Vector | None] = []
        for lane in range(engine.lanes):
            status = Status(int(fates[lane]))
            if status is Status.EVENT:
                found.append(None)
            else:
                failed = np.full(len(channels), np.inf)
                found.append(room[lane, 0] if status is Status.SOLVED else failed)
        return found

    def accuracy(
        self, lane: int, judged: Judged, times: Vector, samples: Samples
    ) -> Accuracy | None:
        """Return what is to be said of a lane at its end, None if that takes a closer look.

        ``samples`` are those of the lane, shape (n_samples, n_columns).
        """
        if not self.channels:
            return Accuracy("accurate", 0.0, "")
        ranges = Ranges.of(self.kernel.equations, self.channels)
        columns = [self.kept.index(k) for k in self.channels]
        ranges.take(np.asarray(samples[:, columns], dtype=float))
        kinds = ranges.kinds(self.kernel.equations)
        for ends in self.ends:
            ranges.take_likes(kinds, ends[lane])
        found = Windows.of(
            _of_lane(self.differences, lane), self.grid, ranges, self.grid.n_intervals + 1
        )
        bound, worst = found.bound()
        if bound > most_bound(self.kernel, self.grid):
            return None
        if judged.balance is not None:
            if self.channels != judged.channels:
                return None
            watch = self._watch(lane, judged, times, self._outputs(samples), _no_rerun)
            if energy_is_off(watch) or lost_energy(watch) > 0.0:
                return None
        name = self.kernel.equations.channels[self.channels[worst]].name
        return Accuracy("accurate", bound, f"'{name}'", None, SPENT * len(found.numbers))

    @property
    def may_look_again(self) -> bool:
        """Whether all lanes may be run again with half the step, to judge them by that."""
        is_halved = self.grid.method != Method.SYMPLECTIC_EULER
        return is_halved and may_be_repeated(self.kernel, self.grid)

    def second_look(
        self, lane: int, judged: Judged, times: Vector, samples: Samples, half: Samples
    ) -> Accuracy | None:
        """Return what a case by itself is said to be, None if that takes other runs than these.

        ``samples`` are those of the lane and ``half`` those with half the step, both of the shape
        (n_samples, n_columns).
        """
        if self.channels != judged.channels:
            return None
        known, again = (self._outputs(values) for values in (samples, half))

        def rerun(
            place: WindowStart, _: float, count: int, way: MethodAndStep, sink: Sink
        ) -> Statistics:
            parts = round(self.grid.step / way.step)
            if place.index or parts > 2 or not math.isclose(way.step * parts, self.grid.step):
                raise _OtherRunError
            nothing, outputs = np.zeros((count + 1, 0)), known if parts == 1 else again
            sink(times[: count + 1], nothing, nothing, outputs[: count + 1])
            steps = parts * count * self.grid.per_interval
            return Statistics("", "", count + 1, steps, 0, 0, 0.0, 0.0)

        watch = self._watch(lane, judged, times, known, rerun)
        rows, halves = _of_lane(self.differences, lane), _of_lane(self.halves, lane)
        found = Windows.of(rows, self.grid, watch.ranges, len(times))
        if watch.hidden(found, halves) is not None:
            return None
        places = [*watch.places, *watch.latest[-1:]][: len(rows)]
        try:
            return watch.judge(places, rows, lambda: halves, ended_early=False)
        except _OtherRunError:
            return None

    def _watch(
        self, lane: int, judged: Judged, times: Vector, outputs: Vector, rerun: Rerun
    ) -> AccuracyMonitor:
        """Return the watch of a case by itself that has the samples of a lane."""
        equations = self.kernel.equations
        watch = AccuracyMonitor(equations, self.grid, judged, rerun)
        nothing = np.zeros((len(times), len(equations.states))), np.zeros((len(times), 0))
        watch.take(self.kernel, times, *nothing, outputs)
        watch.measure_kept()
        kinds = watch.ranges.kinds(equations)
        for ends in self.ends:
            watch.take_end(kinds, np.array(judged.channels), ends[lane])
        return watch

    def _outputs(self, samples: Samples) -> Vector:
        """Return samples with a column for each channel, not a number where it is not kept."""
        found = np.full((len(samples), len(self.kernel.equations.channels)), np.nan)
        found[:, self.kept] = samples
        return found


def _of_lane(parts: list[Vector] | list[Vector | None], lane: int) -> list[Vector | None]:
    """Return the rows of a lane, None where they do not count."""
    rows = [None if part is None else part[lane] for part in parts]
    return [None if row is None or np.isnan(row).all() else row for row in rows]


class _OtherRunError(Exception):
    """A run is asked for that was not taken in lanes."""


def _no_rerun(*_: Any) -> Statistics:
    raise _OtherRunError


def lane_watch(
    kernel: Kernel, grid: StepGrid | None, judged: Judged, columns: list[int]
) -> LaneMonitor | None:
    """Return a watch of lanes whose samples hold the channels ``columns``, None without a grid."""
    if grid is None:
        return None
    return LaneMonitor(kernel, grid, [k for k in judged.channels if k in columns], columns)
