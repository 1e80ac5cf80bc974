"""The windows of cases that run side by side, in which their accuracy is watched."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from vehicledyn.integrate.accuracy.watch import bound_of, most_bound
from vehicledyn.integrate.accuracy.windows import (
    SPENT,
    STEPS,
    Grid,
    total_error,
    two_ends_apart,
    window_count,
    window_places,
)
from vehicledyn.integrate.cases import Samples
from vehicledyn.integrate.channel_ranges import Ranges
from vehicledyn.integrate.estimated_accuracy import Accuracy
from vehicledyn.integrate.judged_quantities import Judged
from vehicledyn.integrate.lane_run import LaneRun
from vehicledyn.kernel.engine import Status, Vector
from vehicledyn.kernel.kernel import Kernel


@dataclass
class LaneWatch:
    """Takes the windows of a run in lanes, at the samples where a case by itself has them.

    ``channels`` are those judged; ``columns`` say where they stand among the samples.
    """

    kernel: Kernel
    grid: Grid
    channels: list[int]
    columns: list[int]
    differences: list[Vector] = field(default_factory=list)
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
        one, other = (self._ends(run, divided) for divided in (1, 2))
        apart = [two_ends_apart(own, half) for own, half in zip(one, other, strict=True)]
        nothing = np.full(len(self.kernel.equations.channels), np.nan)
        self.differences.append(
            np.array([(nothing if a is None else a)[self.channels] for a in apart])
        )
        self.ends.append(np.array([nothing if end is None else end for end in one]))

    def _ends(self, run: LaneRun, divided: int) -> list[Vector | None]:
        """Return the channels of each lane at the end of a window, None behind an event."""
        engine, count = run.engine, STEPS * divided
        window = LaneRun(
            engine,
            run.method,
            self.grid.start + self.grid.interval * (run.step // self.grid.per_interval),
            STEPS * self.grid.step,
            count,
            np.arange(len(self.kernel.equations.channels), dtype=np.intc),
            run.constants,
            _copy(engine.room(len(run.state)), run.state),
            _copy(engine.room(len(run.unknowns)), run.unknowns),
        )
        window.fate.status[:] = Status.SOLVED
        room = np.full((engine.lanes, 1, len(window.channels)), np.nan)
        window.advance(count, room)
        found: list[Vector | None] = []
        for lane in range(engine.lanes):
            status = Status(window.fate.status[lane])
            if status is Status.EVENT:
                found.append(None)
            else:
                failed = np.full(len(window.channels), np.inf)
                found.append(room[lane, 0] if status is Status.SOLVED else failed)
        return found

    def accuracy(self, lane: int, samples: Samples) -> Accuracy | None:
        """Return what is to be said of a lane at its end, None if that takes a closer look.

        ``samples`` are those of the lane, shape (n_samples, n_columns).
        """
        if not self.channels:
            return Accuracy("accurate", 0.0, "")
        ranges = Ranges.of(self.kernel.equations, self.channels)
        ranges.take(np.asarray(samples[:, self.columns], dtype=float))
        kinds = ranges.kinds(self.kernel.equations)
        for ends in self.ends:
            ranges.take_likes(kinds, ends[lane])
        rows = np.array([row[lane] for row in self.differences])
        rows = rows[~np.isnan(rows).all(axis=1)]
        with np.errstate(all="ignore"):
            errors = total_error(rows, self.grid.method) / ranges.scales()
        errors = np.nan_to_num(errors, nan=np.inf, posinf=np.inf)
        bound, worst = bound_of(errors, (self.grid.n_intervals + 1) * self.grid.per_interval)
        if bound > most_bound(self.kernel, self.grid):
            return None
        name = self.kernel.equations.channels[self.channels[worst]].name
        return Accuracy("accurate", bound, f"'{name}'", None, SPENT * len(rows))


def lane_watch(kernel: Kernel, grid: Grid, judged: Judged, columns: list[int]) -> LaneWatch:
    """Return a watch of lanes whose samples hold the channels ``columns``."""
    channels = [k for k in judged.channels if k in columns]
    return LaneWatch(kernel, grid, channels, [columns.index(k) for k in channels])


def _copy(room: Vector, values: Vector) -> Vector:
    room[:] = values
    return room
