"""Run many cases of one model, each with parameters and a start of its own.

Fixed-step methods carry several cases side by side in SIMD lanes, see
:mod:`vehicledyn.solve.lanes`; everything else runs case by case on the kernel itself. The
results of a case are the same, bit for bit, whatever the number of lanes and its neighbours.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.solve.compiler import CompilationError, suitable_lanes
from vehicledyn.solve.engine import Vector
from vehicledyn.solve.fixed_step import steps_per_interval
from vehicledyn.solve.kernel import Kernel, Progress
from vehicledyn.solve.lanes import CHOICES, LaneEngine, compile_lanes
from vehicledyn.solve.platoon import Platoon, Stopped, march
from vehicledyn.solve.simulate import Solver, simulate

_log = logging.getLogger(__name__)

Samples: TypeAlias = NDArray[Any]
"""Values of the chosen channels, float64 or float32, shape (n_cases, n_samples, n_channels)."""


@dataclass(frozen=True)
class Cases:
    """Parameters in SI and starting points, one row a case.

    ``parameters`` (n, n_parameters), ``states`` (n, n_states) and ``unknowns``
    (n, n_unknowns), a guess that is close, in the order of the model's equations.
    """

    parameters: Vector
    states: Vector
    unknowns: Vector

    def __len__(self) -> int:
        """Return the number of cases."""
        return len(self.parameters)

    def part(self, chosen: slice) -> Cases:
        """Return some of the cases."""
        return Cases(self.parameters[chosen], self.states[chosen], self.unknowns[chosen])


@dataclass(frozen=True)
class CaseEnd:
    """How a case ended: ``message`` is empty if it went to its end, else names time and place.

    ``samples`` is the number of good samples, ``time`` that of the last of them [s].
    ``ended_by`` is the name of the terminal event that ended it early; that is no failure.
    """

    time: float
    samples: int
    message: str = ""
    ended_by: str = ""

    @property
    def failed(self) -> bool:
        """Whether the case could not go on."""
        return bool(self.message)


@dataclass(frozen=True)
class BatchResult:
    """Sample times (n_samples,) [s], samples and how each case ended.

    Samples that a case did not reach are not a number.
    """

    times: Vector
    samples: Samples
    ends: tuple[CaseEnd, ...]


@dataclass(frozen=True)
class Plan:
    """When to take samples, and of which channels."""

    start: float
    interval: float
    n_samples: int
    channels: list[int]

    @cached_property
    def times(self) -> Vector:
        """Times of the samples [s], without rounding that adds up."""
        return np.array([self.start + self.interval * k for k in range(self.n_samples)])


Finished: TypeAlias = Callable[[range, Samples, tuple[CaseEnd, ...]], None]
"""Told the numbers of cases that are done, their samples and how they ended."""


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
        Told what is going on.

    Returns
    -------
    Batch
        With one lane, and a remark, where lanes are impossible: for a model with events, an
        interpreted kernel, or a compiler that fails.

    Raises
    ------
    InputError
        If there can be no such number of lanes.
    """
    if lanes is not None and lanes not in CHOICES:
        raise InputError(f"{lanes} lanes are impossible; choose one of 1, 4 and 8")
    most = suitable_lanes()
    wanted = most if lanes is None else min(lanes, most)
    if wanted == 1:
        return Batch(kernel)
    if kernel.equations.events:
        return _one_by_one(kernel, f"model '{kernel.equations.name}' has events")
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
    finished: Finished | None = None,
    progress: Progress | None = None,
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
    finished
        Told of cases as soon as they are done, a few at a time, in order. An interrupt
        (Ctrl-C, heeded within a fifth of a second) loses only those that are under way.
    progress
        Told the part done.

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
    plan = Plan(start, interval, _count_samples(start, stop, interval), list(channels))
    kind = np.float32 if single else np.float64
    samples = np.full((len(cases), plan.n_samples, len(channels)), np.nan, dtype=kind)
    parts = _in_turn if batch.engine is None or not hasattr(solver, "fixed_method") else _abreast
    ends: list[CaseEnd] = []
    for part in parts(batch, solver, cases, plan, samples):
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


def _in_turn(
    batch: Batch, solver: Solver, cases: Cases, plan: Plan, samples: Samples
) -> Iterator[Part]:
    for index in range(len(cases)):
        case = cases.part(slice(index, index + 1))
        yield (_run_case(batch.kernel, solver, case, plan, samples[index]),)
        yield 0.0


def _abreast(
    batch: Batch, solver: Any, cases: Cases, plan: Plan, samples: Samples
) -> Iterator[Part]:
    """Run groups of cases in lanes."""
    engine: Any = batch.engine
    per_interval = steps_per_interval(solver.step, plan.interval)
    for first in range(0, len(cases), engine.lanes):
        group = cases.part(slice(first, first + engine.lanes))
        platoon = Platoon(
            engine,
            solver.fixed_method,
            plan.start,
            plan.interval,
            per_interval,
            np.array(plan.channels, dtype=np.intc),
            engine.prepare(engine.spread(group.parameters)),
            engine.spread(group.states),
            engine.spread(group.unknowns),
        )
        for part in march(platoon, samples[first : first + engine.lanes]):
            yield part * len(group)
        stops = [platoon.stopped(lane) for lane in range(len(group))]
        yield tuple(_end_of(batch.kernel, stopped, plan) for stopped in stops)
        yield 0.0


def _end_of(kernel: Kernel, stopped: Stopped | None, plan: Plan) -> CaseEnd:
    if stopped is None:
        return CaseEnd(float(plan.times[-1]), plan.n_samples)
    last = float(plan.times[max(0, stopped.samples - 1)])
    message = kernel.failure(stopped.status, stopped.time, stopped.ledger)
    return CaseEnd(last, stopped.samples, message)


def _run_case(kernel: Kernel, solver: Solver, case: Cases, plan: Plan, room: Samples) -> CaseEnd:
    last, count = plan.start, 0

    def keep(times: Vector, states: Vector, unknowns: Vector, outputs: Vector) -> None:
        nonlocal last, count
        room[count : count + len(times)] = outputs[: len(room) - count, plan.channels]
        last, count = float(times[-1]), count + len(times)

    try:
        done = simulate(
            kernel.with_parameters(case.parameters[0]),
            solver,
            start=plan.start,
            stop=float(plan.times[-1]),
            state=case.states[0],
            unknowns=case.unknowns[0],
            interval=plan.interval,
            sink=keep,
        )
    except NumericalError as error:
        return CaseEnd(last, count, str(error))
    return CaseEnd(last, count, ended_by=done.ended_by or "")


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
