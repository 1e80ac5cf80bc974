"""Run many cases of one model, each with parameters and a start of its own.

Methods with steps of one size, and Newmark's family, carry cases side by side in SIMD lanes, see
:mod:`vehicledyn.kernel.lanes`; others run case by case on the kernel itself. A case in which an
event fires, a loop comes near to a singular configuration, or Newton's method does not converge,
leaves its lane and is run by itself, the others go on. The results of a case are the same, bit for
bit, whatever the number of lanes and its neighbours.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, TypeAlias

import numpy as np

from vehicledyn.base.argument_names import given
from vehicledyn.base.errors import InputError
from vehicledyn.codegen.toolchain.compiler import CompilationError, suitable_lanes
from vehicledyn.integrate.accuracy.lanes import LaneMonitor, lane_watch
from vehicledyn.integrate.accuracy.windows import StepGrid
from vehicledyn.integrate.cases import CaseEnd, Cases, Samples, SamplingPlan
from vehicledyn.integrate.channel_ranges import watched_channels
from vehicledyn.integrate.fixed_step import steps_per_interval
from vehicledyn.integrate.judged_quantities import Judged
from vehicledyn.integrate.lane_march import march
from vehicledyn.integrate.lane_run import FixedLaneRun, LaneRun, Stopped, takes_lanes
from vehicledyn.integrate.newmark.lane_run import LaneMethod, NewmarkLaneRun
from vehicledyn.integrate.simulate import Solver, simulate
from vehicledyn.integrate.single_case import Judging, Runner, SingleCase
from vehicledyn.kernel.engine import WEAK_PIVOT, Status, Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.lanes import CHOICES, LaneEngine, compile_lanes
from vehicledyn.kernel.make_kernel import Progress
from vehicledyn.kernel.newmark.newmark_code import newmark_lanes
from vehicledyn.kernel.rate_monitor import RateMonitor, Soundness

_log = logging.getLogger(__name__)

_MOST_NUMBERS = 20_000_000
"""Samples that lanes keep a second time to be judged."""

__all__ = [
    "Batch",
    "BatchResult",
    "CaseEnd",
    "Cases",
    "Finished",
    "Samples",
    "make_batch",
    "run_batch",
]


@dataclass(frozen=True)
class BatchResult:
    """Sample times (n_samples,) [s], samples and how each case ended.

    Samples that a case did not reach are not a number.
    """

    times: Vector
    samples: Samples
    ends: tuple[CaseEnd, ...]


Finished: TypeAlias = Callable[[range, Samples, tuple[CaseEnd, ...]], None]
"""Called with the numbers of cases that are done, their samples and how they ended."""


Room: TypeAlias = Callable[[tuple[int, ...]], Samples]
"""Gives an array of a shape."""


@dataclass(frozen=True)
class Batch:
    """A kernel made ready for many cases; ``remark`` is one line for the user, or empty."""

    kernel: Kernel
    engine: LaneEngine | None = None
    remark: str = ""

    @property
    def lanes(self) -> int:
        """How many cases run side by side."""
        return self.engine.lanes if self.engine is not None else 1


def make_batch(
    kernel: Kernel, *, lanes: int | None = None, progress: Progress | None = None
) -> Batch:
    """Return a kernel made ready for many cases.

    Parameters
    ----------
    kernel
        The model.
    lanes
        Cases side by side: 1, 4 or 8; None for what suits this processor, which is also the
        most that it is given.
    progress
        Called with what is going on.

    Returns
    -------
    Batch
        With one lane, and a remark, where lanes are impossible: for an interpreted kernel, or a
        compiler that fails.

    Raises
    ------
    InputError
        If there can be no such number of lanes.
    """
    if lanes is not None and lanes not in CHOICES:
        raise InputError(f"{given('lanes', lanes)}: choose 1, 4 or 8")
    most = suitable_lanes()
    wanted = most if lanes is None else min(lanes, most)
    if wanted == 1:
        return Batch(kernel)
    if kernel.backend != "compiled":
        return _one_by_one(kernel, "the kernel is interpreted")
    if progress is not None:
        progress(f"making the kernel for {wanted} cases side by side", None)
    try:
        engine, remark = compile_lanes(kernel.equations, kernel.key, wanted)
    except CompilationError as error:
        return _one_by_one(kernel, str(error))
    if remark:
        _log.warning(remark)
    return Batch(kernel, engine, remark)


def _one_by_one(kernel: Kernel, reason: str) -> Batch:
    remark = f"{reason}; cases run one after the other"
    _log.warning(remark)
    return Batch(kernel, remark=remark)


def run_batch(
    batch: Batch,
    solver: Solver,
    cases: Cases,
    *,
    start: float,
    stop: float,
    interval: float,
    channels: Sequence[int],
    single: bool = False,
    runner: Runner = simulate,
    rates: RateMonitor | None = None,
    judged: Judging | None = None,
    finished: Finished | None = None,
    progress: Progress | None = None,
    room: Room = np.empty,
) -> BatchResult:
    """Integrate all cases from ``start`` to ``stop``.

    Parameters
    ----------
    batch
        From :func:`make_batch`.
    solver
        Settings of a method, one of the family "solver".
    cases
        Parameters and starting points.
    start, stop
        First and last time [s]; the last sample is the last multiple of the interval.
    interval
        Time between samples [s].
    channels
        Indices of the channels to keep, in the order wanted.
    single
        Whether samples are kept as float32, which halves the memory.
    runner
        Integrates cases whose loops fail or come near to singular configurations and changes
        their dependent coordinates.
    rates
        Says how well constraints without loops determine the dependent rates, where a model has
        such; cases in which they become weak are left to the runner as well.
    judged
        Gives what the accuracy of a case, by number, is judged by; the channels that are kept if
        left out.
    finished
        Called with cases as soon as they are done, a few at a time, in order. An interrupt
        (Ctrl-C, heeded within a fifth of a second) loses only those that are under way.
    progress
        Called with the part done.
    room
        Makes the samples, those of float64.

    Returns
    -------
    BatchResult
        A case that fails stops alone and says where; the others go on.

    Raises
    ------
    InputError
        If sizes or times make no sense, or the step does not divide the interval.
    """
    _check_cases(batch.kernel, cases)
    if getattr(solver, "step", 0.0) is None:
        raise InputError("a batch needs solver.step: its cases take their steps together")
    plan = SamplingPlan(start, interval, _count_samples(start, stop, interval), list(channels))
    shape = len(cases), plan.n_samples, len(channels)
    samples = np.empty(shape, np.float32) if single else room(shape)
    samples[:] = np.nan
    parts = _abreast if _runs_in_lanes(batch, solver) else _in_turn
    alone = SingleCase(
        batch.kernel, solver, plan, runner, rates, judged or _by_channels(batch, plan)
    )
    ends: list[CaseEnd] = []
    for part in parts(batch, cases, samples, alone):
        if isinstance(part, float):
            if progress is not None:
                progress("simulating", (len(ends) + part) / len(cases))
            continue
        which = range(len(ends), len(ends) + len(part))
        ends += part
        if finished is not None:
            finished(which, samples[which.start : which.stop], part)
    return BatchResult(plan.times, samples, tuple(ends))


Part: TypeAlias = float | tuple[CaseEnd, ...]
"""How many cases are done behind those that ended last, or how the next ones ended."""


def _runs_in_lanes(batch: Batch, solver: Any) -> bool:
    if batch.engine is None or not takes_lanes(solver):
        return False
    try:
        if not hasattr(solver, "fixed_method"):
            newmark_lanes(batch.lanes)
    except CompilationError as error:
        _log.warning("%s; cases run one after the other", error)
        return False
    return True


def _in_turn(batch: Batch, cases: Cases, samples: Samples, alone: SingleCase) -> Iterator[Part]:
    for index in range(len(cases)):
        yield (alone.run(cases, index, samples[index]),)
        yield 0.0


def _abreast(batch: Batch, cases: Cases, samples: Samples, alone: SingleCase) -> Iterator[Part]:
    """Run groups of cases in lanes."""
    plan, solver = alone.plan, alone.solver
    per_interval = steps_per_interval(getattr(solver, "step", 0.0), plan.interval)
    times = plan.start, plan.interval, per_interval, plan.n_samples - 1
    grid = StepGrid.of(solver, *times)
    further = [] if alone.rates is None else list(alone.rates.channels)
    for first in range(0, len(cases), batch.lanes):
        group = cases.part(slice(first, first + batch.lanes))
        make = partial(_lane_run, batch, alone, group, further)
        run, room = make(per_interval), samples[first : first + batch.lanes]
        if further:
            room = np.full((*room.shape[:2], len(run.channels)), np.nan)
        watch = lane_watch(batch.kernel, grid, alone.judged(first), plan.channels)
        for part in march(run, room, watch):
            yield part * len(group)
        if further:
            samples[first : first + batch.lanes] = room[:, :, : len(plan.channels)]
        ends = _ends(batch, alone, run, room)
        if watch:
            judging = watch, lambda lane, first=first: alone.judged(first + lane), alone.plan
            _judge(ends, room, judging, partial(make, 2 * per_interval))
        for lane, end in enumerate(ends):
            if end is None or (watch and end.accuracy is None and not end.failed):
                samples[first + lane] = np.nan
                ends[lane] = alone.run(cases, first + lane, samples[first + lane])
        yield tuple(end for end in ends if end is not None)
        yield 0.0


def _lane_run(
    batch: Batch, alone: SingleCase, group: Cases, further: list[int], per_interval: int
) -> LaneRun:
    """Return cases side by side that have not begun."""
    engine: Any = batch.engine
    solver: Any = alone.solver
    given = (
        engine,
        alone.plan.start,
        alone.plan.interval,
        per_interval,
        np.array([*alone.plan.channels, *further], dtype=np.intc),
        engine.prepare(engine.spread(group.parameters)),
        engine.spread(group.states),
        engine.spread(group.unknowns),
        WEAK_PIVOT if alone.has_loops else 0.0,
    )
    if hasattr(solver, "fixed_method"):
        return FixedLaneRun(*given, method=solver.fixed_method)
    return NewmarkLaneRun(*given, method=LaneMethod.of(batch.kernel, solver))


def _ends(batch: Batch, alone: SingleCase, run: LaneRun, room: Samples) -> list[CaseEnd | None]:
    """Return how the lanes ended, None for those that are to be run by themselves."""
    is_left = alone.is_watched or not hasattr(alone.solver, "fixed_method")
    ends: list[CaseEnd | None] = []
    for lane in range(len(room)):
        stopped = run.stopped(lane)
        if stopped is None:
            ends.append(None if _is_weak(alone, room[lane]) else _whole(alone.plan))
        else:
            is_open = is_left or stopped.status is Status.EVENT
            ends.append(None if is_open else _failed(batch.kernel, stopped, alone.plan))
    return ends


def _judge(
    ends: list[CaseEnd | None],
    room: Samples,
    judging: tuple[LaneMonitor, Judging, SamplingPlan],
    finer: Callable[[], LaneRun],
) -> None:
    """Say how accurate the lanes are that came to their end, as far as lanes can tell.

    Where windows do not suffice for several of them, all are run again with half the step.
    """
    watch, judged, plan = judging
    width = len(plan.channels)
    is_open = []
    for lane, end in enumerate(ends):
        if end is not None and not end.failed:
            found = watch.accuracy(lane, judged(lane), plan.times, room[lane, :, :width])
            ends[lane] = replace(end, accuracy=found)
            is_open += [lane] if found is None else []
    numbers = max(room.size, 2 * len(plan.times) * len(watch.kernel.equations.channels))
    if len(is_open) < 2 or not watch.may_look_again or numbers > _MOST_NUMBERS:
        return
    run, half = finer(), np.full(room.shape, np.nan)
    for _ in march(run, half):
        pass
    for lane in is_open:
        if run.stopped(lane) is None:
            parts = (part[lane, :, :width] for part in (room, half))
            found = watch.second_look(lane, judged(lane), plan.times, *parts)
            ends[lane] = replace(_whole(plan), accuracy=found)


def _is_weak(alone: SingleCase, samples: Samples) -> bool:
    """Return whether dependent rates are ill determined at samples, the channels for it last."""
    if alone.rates is None:
        return False
    values = samples[:, len(alone.plan.channels) :]
    return not Soundness().holds(alone.rates.determinants(alone.plan.times, values)[:, None])


def _by_channels(batch: Batch, plan: SamplingPlan) -> Judging:
    """Return that all cases are judged by the channels that are kept."""
    known = set(watched_channels(batch.kernel.equations))
    judged = Judged([k for k in plan.channels if k in known], by_itself=False)
    return lambda _: judged


def _whole(plan: SamplingPlan) -> CaseEnd:
    return CaseEnd(float(plan.times[-1]), plan.n_samples)


def _failed(kernel: Kernel, stopped: Stopped, plan: SamplingPlan) -> CaseEnd:
    last = float(plan.times[max(0, stopped.samples - 1)])
    message = kernel.failure(stopped.status, stopped.time, stopped.ledger)
    return CaseEnd(last, stopped.samples, message)


def _check_cases(kernel: Kernel, cases: Cases) -> None:
    e = kernel.equations
    wanted = {
        "parameters": (cases.parameters, len(e.parameters)),
        "states": (cases.states, len(e.states)),
        "unknowns": (cases.unknowns, len(e.unknowns)),
    }
    for words, (array, width) in wanted.items():
        if array.shape != (len(cases), width):
            raise InputError(
                f"the {words} of {len(cases)} cases of model '{e.name}' must have the shape "
                f"{(len(cases), width)}, not {array.shape}"
            )
        if not np.isfinite(array).all():
            row = int(np.flatnonzero(~np.isfinite(array).all(axis=1))[0])
            raise InputError(f"the {words} of case {row} hold a value that is not finite")


def _count_samples(start: float, stop: float, interval: float) -> int:
    for name, value in (("start", start), ("stop", stop), ("interval", interval)):
        if not math.isfinite(value):
            raise InputError(f"the {name} of a simulation must be a finite time, not {value}")
    if interval <= 0.0:
        raise InputError(f"the sampling interval must be positive, not {interval:g} s")
    if stop < start:
        raise InputError(f"the simulation stops at {stop:g} s, before its start at {start:g} s")
    return math.floor((stop - start) / interval * (1.0 + 1e-12) + 1e-9) + 1
