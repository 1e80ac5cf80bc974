"""What a run in pieces is asked for: its times, its looks at the motion, and who takes what."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vehicledyn.integrate.course import MethodState, RunHistory
from vehicledyn.integrate.fixed_step import FixedSteps
from vehicledyn.integrate.simulate import Solver, make_task
from vehicledyn.integrate.task import EachStep, Happened, Sink, Statistics, StepError
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.make_kernel import Progress

Vector = NDArray[np.float64]

KernelSink: TypeAlias = Callable[[Kernel, Vector, Vector, Vector, Vector], None]
"""Takes a kernel and times (n,), states, unknowns and outputs (n, ...) of its samples, in order."""

_ON_GRID = 1e-6
"""Part of an interval that a time may lie beside the grid it belongs to."""


class PieceStart(NamedTuple):
    """Where a piece begins: time [s], states and unknowns."""

    time: float
    state: Vector
    unknowns: Vector


@dataclass(frozen=True)
class RunPlan:
    """Times of a run, how it is integrated, and who takes its samples, events and progress.

    ``interval`` is that between looks at the motion; every ``every``-th of them is a sample that
    is asked for. ``hint`` gives a few words on the step for a run that fails.
    """

    solver: Solver
    start: float
    stop: float
    interval: float
    every: int
    sink: KernelSink
    progress: Progress
    happened: Happened
    hint: Callable[[], str] = str

    @property
    def step(self) -> float | None:
        """Fixed step of the method [s], None where it varies."""
        return getattr(self.solver, "step", None)

    @property
    def n_looks(self) -> int:
        """Number of intervals between looks up to the last sample."""
        whole = (self.stop - self.start) / (self.interval * self.every)
        return self.every * math.floor(whole * (1.0 + 1e-12) + 1e-9)

    @property
    def end(self) -> float:
        """Time of the last sample [s]."""
        return self.time(self.n_looks)

    def time(self, index: int) -> float:
        """Return the time of a look [s]."""
        return self.start + self.interval * index

    def index(self, time: float) -> int:
        """Return the number of the first look at or behind a time."""
        return math.ceil((time - self.start) / self.interval - 1e-9)

    def is_look(self, times: Any) -> Any:
        """Return whether times are those of looks, not of a terminal event between them."""
        numbers = (times - self.start) / self.interval
        return np.abs(numbers - np.round(numbers)) <= _ON_GRID

    def is_wanted(self, times: Any) -> Any:
        """Return whether samples are asked for, as those of a terminal event are too."""
        numbers = np.round((times - self.start) / self.interval)
        return ~self.is_look(times) | (numbers % self.every == 0)

    def report(self, what: str, part: float | None, latest: float | None) -> None:
        """Report what a piece is doing, with the part of the whole run that is done."""
        if part is not None and latest is not None and self.stop > self.start:
            part = (latest - self.start) / (self.stop - self.start)
        self.progress(what, part)

    def integrate(
        self,
        kernel: Kernel,
        begin: PieceStart,
        stop: float,
        *,
        sink: Sink,
        parts: list[Statistics],
        progress: Progress,
        course: RunHistory | None = None,
        each_step: EachStep | None = None,
        carried: MethodState | None = None,
    ) -> Statistics:
        """Integrate a piece of the run, from look to look.

        ``carried`` is what the method knows from the piece before, and leaves for the next.

        Its statistics are added to ``parts``, also where it is broken off. The accuracy is not
        judged; that is done for the run as a whole.
        """
        task = make_task(
            kernel,
            start=begin.time,
            stop=stop,
            state=begin.state,
            unknowns=begin.unknowns,
            interval=self.interval,
            sink=sink,
            progress=progress,
            happened=self.happened,
            course=course,
            watched=False,
            each_step=each_step,
            carried=carried,
        )
        try:
            return self.solver.integrate(task)
        except StepError as error:
            raise StepError(f"{error}{self.hint()}") from None
        finally:
            parts.append(task.statistics(getattr(self.solver, "kind", "")))

    def follow(
        self,
        kernel: Kernel,
        begin: PieceStart,
        stop: float,
        *,
        count: int,
        sink: Sink,
        parts: list[Statistics],
    ) -> None:
        """Integrate once more to a time, in so many intervals, with nothing reported.

        A fixed step becomes a little shorter where it does not divide them.
        """
        interval, solver = (stop - begin.time) / count, self.solver
        if self.step is not None:
            fixed: Any = solver
            parts_of_it = max(1, math.ceil(interval / self.step - 1e-6))
            shorter = interval / parts_of_it
            if hasattr(fixed, "fixed_method"):
                solver = FixedSteps(fixed.fixed_method, shorter)
            else:
                solver = fixed.model_copy(update={"step": shorter})
        task = make_task(
            kernel,
            start=begin.time,
            stop=stop,
            state=begin.state,
            unknowns=begin.unknowns,
            interval=interval,
            sink=sink,
            watched=False,
        )
        try:
            solver.integrate(task)
        finally:
            # Its events are those of the run, which are counted there.
            parts.append(replace(task.statistics(""), samples=0, events=0))

    def looked_at(self, *, steps: int) -> RunPlan:
        """Return the same plan with looks between its samples, see ``looks_per_interval``."""
        count = looks_per_interval(self.step, self.interval, steps=steps)
        return replace(self, interval=self.interval / count, every=self.every * count)


def looks_per_interval(
    step: float | None, interval: float, *, steps: int, span: float = 0.02
) -> int:
    """Return how often the motion is looked at in a sampling interval.

    With a fixed step that is about every so many ``steps``, a divisor of their number; else at
    least once in ``span`` [s].
    """
    if step is None:
        return max(1, math.ceil(interval / span))
    count = max(1, round(interval / step))
    return next(k for k in range(max(1, count // steps), 0, -1) if count % k == 0)
