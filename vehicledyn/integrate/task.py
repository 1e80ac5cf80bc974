"""What an integration method is given and gives back: a task with a sink, and statistics."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.course import Beginning, MethodState, RunHistory
from vehicledyn.integrate.events import ConsistentPoint, EventMonitor
from vehicledyn.kernel.engine import Count, Figure, Ledger, SampleRows, Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.make_kernel import Progress

if TYPE_CHECKING:
    from vehicledyn.integrate.estimated_accuracy import Accuracy
    from vehicledyn.integrate.judged_quantities import Judged

Sink: TypeAlias = Callable[[Vector, Vector, Vector, Vector], None]
"""Takes times (n,), states, unknowns and outputs (n, ...) of samples, in order."""

Happened: TypeAlias = Callable[[str, float], None]
"""Called with name and time [s] of each event, in order, when it happens."""

_MOST_NUMBERS = 1_000_000


EachStep: TypeAlias = Callable[[float, Vector, Vector, float], None]
"""Called at the end of a step with its time [s], states, unknowns and size [s]; may raise."""


class StepError(NumericalError):
    """A step of fixed size that cannot be taken, as its loops or its numbers fail."""


@dataclass(frozen=True)
class Statistics:
    """What an integration took.

    ``steps`` count also those that were taken once more, ``evaluations`` are those of the rates,
    ``newton_iterations`` those of all blocks together. Step sizes [s] are there where the method
    reports them, ``largest_residual`` is that of the blocks at the samples, in the residual's unit.
    ``events`` is the number of events that happened, ``ended_by`` the name of the terminal event
    that ended the run early. ``accuracy`` is what the watch of a method with a fixed step found.
    """

    method: str
    backend: str
    samples: int
    steps: int
    evaluations: int
    newton_iterations: int
    largest_residual: float
    wall_seconds: float
    smallest_step: float | None = None
    largest_step: float | None = None
    events: int = 0
    ended_by: str | None = None
    accuracy: Accuracy | None = None


def joined(parts: Sequence[Statistics]) -> Statistics:
    """Return the statistics of consecutive parts of one run together."""
    sums = ("samples", "steps", "evaluations", "newton_iterations", "events", "wall_seconds")
    totals = {key: sum(getattr(part, key) for part in parts) for key in sums}
    largest = max(part.largest_residual for part in parts)
    known = [size for part in parts for size in (part.smallest_step, part.largest_step) if size]
    return replace(
        parts[-1],
        **totals,
        largest_residual=largest,
        smallest_step=min(known, default=None),
        largest_step=max(known, default=None),
    )


@dataclass
class Task:
    """One integration: where it starts, when it is sampled, and where the samples go.

    Sample number k is taken at ``start + k * interval``; ``state`` and ``unknowns`` are those
    of sample 0, consistent, or of the beginning of a continued run. ``judged`` is what the accuracy
    is judged by, all channels where it is None; ``watched`` whether it is judged at all.
    ``each_step`` is called by methods that choose the size of their steps, but for those inside
    libraries. ``carried`` is what the method knows from the piece of the run before and leaves for
    the next, None for a run in one piece. ``steps`` are those taken so far, ``sizes`` the least and
    the largest of them [s].
    """

    kernel: Kernel
    start: float
    interval: float
    n_intervals: int
    state: Vector
    unknowns: Vector
    sink: Sink
    progress: Progress
    happened: Happened
    judged: Judged | None = None
    course: RunHistory | None = None
    watched: bool = True
    each_step: EachStep | None = None
    carried: MethodState | None = None
    delivered: int = 0
    steps: int = 0
    sizes: tuple[float, float] | None = None
    ledger: Ledger = field(default_factory=Ledger)
    started: float = field(default_factory=time.perf_counter)
    watch: EventMonitor = field(init=False)

    def __post_init__(self) -> None:
        """Watch the events from the start on."""
        if self.beginning is not None:
            self.delivered = round((self.beginning.time - self.start) / self.interval) + 1
        start = ConsistentPoint(self.begin, self.state, self.unknowns)
        self.watch = EventMonitor(self.kernel, start, self.ledger, self.happened)

    @property
    def beginning(self) -> Beginning | None:
        """Where a continued run begins; None for one from its start."""
        return None if self.course is None else self.course.beginning

    @property
    def begin(self) -> float:
        """Time of ``state`` and ``unknowns`` [s]."""
        return self.start if self.beginning is None else self.time(self.delivered - 1)

    def note(self, history: Vector) -> None:
        """Note what the method needs to go on from about the last sample."""
        if self.course is not None and self.delivered:
            self.course.note(self.time(self.delivered - 1), history)

    @property
    def finished(self) -> bool:
        """Whether the last sample has been delivered."""
        return self.delivered > self.n_intervals

    def time(self, index: int) -> float:
        """Return the time of a sample [s], without rounding that adds up."""
        return self.start + self.interval * index

    def rows(self, n_samples: int) -> SampleRows:
        """Return room for this many samples, or as many as fit into the memory set aside."""
        equations = self.kernel.equations
        widths = [len(equations.states), len(equations.unknowns), len(equations.channels)]
        n_rows = max(2, min(n_samples, _MOST_NUMBERS // max(1, sum(widths))))
        return SampleRows(*[np.zeros((n_rows, width)) for width in widths])

    def deliver(self, rows: SampleRows, n_samples: int) -> None:
        """Hand the first samples of the rows to the sink."""
        if n_samples:
            indices = range(self.delivered, self.delivered + n_samples)
            times = np.array([self.time(index) for index in indices])
            parts = (rows.states, rows.unknowns, rows.outputs)
            self.sink(times, *[part[:n_samples].copy() for part in parts])
            self.delivered += n_samples
        part = (self.delivered - 1) / self.n_intervals if self.n_intervals else 1.0
        self.progress("simulating", part)

    def deliver_point(self, point: ConsistentPoint) -> None:
        """Hand one sample to the sink, at the end of an interval or where an event ends the run.

        Raises
        ------
        NumericalError
            If a block is not solved there.
        """
        self.kernel.check_residuals(*point, self.ledger)
        outputs = self.kernel.outputs(*point)
        parts = (point.state, point.unknowns, outputs)
        self.sink(np.array([point.time]), *[np.array([part]) for part in parts])
        self.delivered += 1
        part = self.delivered / (self.n_intervals + 1)
        self.progress("simulating", 1.0 if self.watch.ended_by else part)

    def count_steps(self, count: int, size: float | None = None) -> None:
        """Count further steps, all of one size [s] where it is given."""
        self.steps += count
        if size is not None:
            low, high = self.sizes or (size, size)
            self.sizes = (min(low, size), max(high, size))

    def statistics(self, method: str, *, accuracy: Accuracy | None = None) -> Statistics:
        """Return the statistics up to now, of an integration that ended or was broken off."""
        return Statistics(
            method=method,
            backend=self.kernel.description,
            samples=self.delivered,
            steps=self.steps,
            evaluations=int(self.ledger.counts[Count.EVALUATIONS]),
            newton_iterations=int(self.ledger.counts[Count.ITERATIONS]),
            largest_residual=float(self.ledger.figures[Figure.LARGEST_RESIDUAL]),
            wall_seconds=time.perf_counter() - self.started,
            smallest_step=self.sizes[0] if self.sizes else None,
            largest_step=self.sizes[1] if self.sizes else None,
            events=self.watch.count,
            ended_by=self.watch.ended_by or None,
            accuracy=accuracy,
        )


class SampleBuffer:
    """Collects samples found one at a time, and hands them on every tenth of a second."""

    def __init__(self, task: Task, state: Vector, unknowns: Vector) -> None:
        """Start at sample 0 with these values, or behind the beginning of a continued run."""
        self._task = task
        self._rows = task.rows(task.n_intervals + 1)
        self._count = 0
        self._flushed = time.perf_counter()
        self._unknowns = unknowns
        if task.beginning is None:
            self.add(state, unknowns)

    @property
    def next_index(self) -> int:
        """Number of the sample to come."""
        return self._task.delivered + self._count

    def add(self, state: Vector, guess: Vector, outputs: Vector | None = None) -> None:
        """Enter the next sample: solve its unknowns from a guess, find outputs that are not given.

        Raises
        ------
        NumericalError
            If a block is not solved.
        """
        task, rows = self._task, self._rows
        moment = task.time(self.next_index)
        unknowns = task.kernel.count_solve(moment, state, guess, task.ledger)
        rows.states[self._count], rows.unknowns[self._count] = state, unknowns
        if outputs is None:
            outputs = task.kernel.outputs(moment, state, unknowns)
        rows.outputs[self._count] = outputs
        self._count += 1
        if self._count == len(rows.states) or time.perf_counter() > self._flushed + 0.1:
            self.flush()

    def flush(self) -> None:
        """Hand on what has been collected."""
        count, self._count = self._count, 0
        self._task.deliver(self._rows, count)
        self._flushed = time.perf_counter()
