"""Short stretches of a run taken again with its step and with half of it, for their difference.

Forces whose period divides the step and half of it act on both alike, whatever they are between.
Every second window therefore has uneven steps in place of halves, which have no measure in common.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.simulate import simulate
from vehicledyn.kernel.engine import Count, March, Method, SampleRows, Status, Vector
from vehicledyn.kernel.kernel import Kernel

STEPS = 4
"""Steps of a window: an unstable mode has shown itself by then, and the price is low."""

Pieces: TypeAlias = Sequence[tuple[float, int]]
"""Parts of a window, of which each has so many steps."""

WHOLE: Pieces = ((1.0, STEPS),)
HALF: Pieces = ((1.0, 2 * STEPS),)
UNEVEN: Pieces = ((3.0**-0.5, 5), (1.0 - 3.0**-0.5, 3))
"""The steps of the run, halves, and as many that are 0.462 and 0.564 of a step."""

SPENT = 3 * STEPS
"""Steps that a window takes, with the step and with half of it."""

_CHEAP = 2.5e9
"""Operations of a whole run that are always worth their price when it is judged."""

_QUICK, _CLOSER = 4e6, (15, 7, 5)
"""Operations that a run by itself may always spend on a look with much shorter steps, and in how
many parts these divide a step."""

_SHARE, _LEAST_WINDOWS, _MOST_WINDOWS = 0.01, 2, 16
_OVERHEAD, _FREE = 6e5, 6e6
"""Operations that calling a window costs, and that a run by itself may always spend on them."""


_ITERATIONS, _INTERPRETED = 4, 300
"""Evaluations of the rates in an implicit step, and what an interpreted one costs."""


@dataclass(frozen=True)
class StepGrid:
    """When a run with a fixed step takes its steps and samples; ``method`` as in ``March``.

    ``solver`` are the settings of a method whose steps are taken outside of the kernel.
    """

    method: int
    start: float
    interval: float
    per_interval: int
    n_intervals: int
    solver: Any = None

    @classmethod
    def of(
        cls, solver: Any, start: float, interval: float, per_interval: int, n_intervals: int
    ) -> StepGrid | None:
        """Return the grid of a method with a fixed step by its settings, None for others."""
        times = start, interval, per_interval, n_intervals
        if hasattr(solver, "fixed_method"):
            return cls(solver.fixed_method, *times)
        method = getattr(solver, "monitored_method", None)
        return None if method is None else cls(method, *times, solver)

    @property
    def step(self) -> float:
        """Step size [s]."""
        return self.interval / self.per_interval

    @property
    def n_steps(self) -> int:
        """Number of steps of the whole run."""
        return self.n_intervals * self.per_interval


@dataclass(frozen=True)
class WindowStart:
    """A sample that a window begins at: number, time [s], states, unknowns, and their kernel."""

    index: int
    time: float
    state: Vector
    unknowns: Vector
    kernel: Kernel


def order_of(method: int) -> int:
    """Return the order of a fixed-step method."""
    if method >= Method.IMPLICIT:
        return method % Method.IMPLICIT
    if method >= Method.CHEBYSHEV:
        return 2
    return 4 if method == Method.RK4 else 1


def stages_of(method: int) -> int:
    """Return how often a step evaluates the rates, or what takes as long."""
    if method >= Method.IMPLICIT:
        return _INTERPRETED if method >= Method.CONSTRAINED else _ITERATIONS
    if method >= Method.CHEBYSHEV:
        return method - Method.CHEBYSHEV
    return 4 if method == Method.RK4 else 1


def total_error(difference: Vector, method: int) -> Vector:
    """Return the error of a step from how far half of it leads elsewhere (Richardson)."""
    power = 2.0 ** order_of(method)
    return difference * (power / (power - 1.0))


def two_ends_apart(one: Vector | None, other: Vector | None) -> Vector | None:
    """Return how far two ends of a window lie apart, None where an event is in both.

    Infinite where an event is in one of them only, or one is no number and the other is.
    """
    if one is None and other is None:
        return None
    if one is None or other is None:
        known = other if one is None else one
        nowhere: Vector = np.full(0 if known is None else len(known), np.inf)
        return nowhere
    with np.errstate(all="ignore"):
        distance: Vector = np.abs(one - other)
    if np.isfinite(distance).all():
        return distance
    same = np.isnan(one) & np.isnan(other)
    apart: Vector = np.where(same, 0.0, np.where(np.isnan(distance), np.inf, distance))
    return apart


def is_stuck(end: Vector | None) -> bool:
    """Return whether a window did not get to its end."""
    return end is not None and bool(np.isinf(end).all())


class WindowEnds:
    """Takes windows of a run with one kernel, in memory that serves for all of them.

    Parameters
    ----------
    grid
        The run.
    kernel
        That of the places where windows begin.
    """

    def __init__(self, grid: StepGrid, kernel: Kernel) -> None:
        self._grid, self.kernel = grid, kernel
        e = kernel.equations
        state, unknowns = np.zeros(len(e.states)), np.zeros(len(e.unknowns))
        sides = np.zeros(len(e.events), dtype=np.intc)
        span = STEPS * grid.step
        self._march = March(grid.method, 0.0, span, STEPS, state, unknowns, sides=sides)
        self._rows = SampleRows(
            *[np.zeros((2, len(part))) for part in (state, unknowns, e.channels)]
        )

    def end(self, place: WindowStart, pieces: Pieces) -> Vector | None:
        """Return the channels at the end of a window with some steps.

        Parameters
        ----------
        place
            Where the window begins.
        pieces
            Its parts with the steps in each.

        Returns
        -------
        Vector or None
            Shape (n_channels,), infinite where the end is not reached; None where an event
            interrupts.
        """
        if self._grid.solver is not None:
            return _solved_end(self._grid, place, pieces)
        march = self._march
        march.state[:], march.unknowns[:] = place.state, place.unknowns
        for start, span, count in timed(self._grid, place.time, pieces):
            march.start, march.interval, march.step, march.per_interval = start, span, 0, count
            march.memory[:], march.sides[:] = 0.0, 0
            status = self.kernel.advance(march, count, self._rows)
            if status is Status.EVENT:
                return None
            if status is not Status.SOLVED or not march.ledger.counts[Count.SAMPLES]:
                return np.full(self._rows.outputs.shape[1], np.inf)
        found: Vector = self._rows.outputs[0].copy()
        return found


def timed(grid: StepGrid, begin: float, pieces: Pieces) -> list[tuple[float, float, int]]:
    """Return start [s], length [s] and number of steps of the pieces of a window."""
    found, part = [], 0.0
    for share, count in pieces:
        span = STEPS * grid.step
        found.append((begin + part * span, share * span, count))
        part += share
    return found


def _solved_end(grid: StepGrid, place: WindowStart, pieces: Pieces) -> Vector | None:
    """Return the same for a method whose steps are taken outside of the kernel."""
    found: list[tuple[Vector, Vector, Vector]] = []
    state, unknowns = place.state, place.unknowns

    def keep(_: Vector, states: Vector, unknowns: Vector, outputs: Vector) -> None:
        found.append((states[-1].copy(), unknowns[-1].copy(), outputs[-1].copy()))

    for start, span, count in timed(grid, place.time, pieces):
        try:
            done = simulate(
                place.kernel,
                grid.solver.model_copy(update={"step": span / count}),
                start=start,
                stop=start + span,
                state=state,
                unknowns=unknowns,
                interval=span,
                sink=keep,
                watched=False,
            )
        except NumericalError:
            return np.full(len(place.kernel.equations.channels), np.inf)
        if done.events:
            return None
        state, unknowns, outputs = found[-1]
    return outputs


def operations_of_step(kernel: Kernel, method: int) -> float:
    """Return about how many operations a step of a run takes."""
    counted = kernel.report.operations
    once = counted.get("rates", 0) + 2 * counted.get("blocks", 0)
    return float(max(50, once) * stages_of(method))


def is_cheap(kernel: Kernel, method: int, steps: float) -> bool:
    """Return whether so many steps may be taken at any time when a run is judged."""
    return kernel.backend == "compiled" and steps * operations_of_step(kernel, method) <= _CHEAP


def may_be_repeated(kernel: Kernel, grid: StepGrid) -> bool:
    """Return whether a whole run with half the step is cheap."""
    return is_cheap(kernel, grid.method, 2.0 * grid.n_steps)


def closer_parts(kernel: Kernel, grid: StepGrid) -> int | None:
    """Return into how many parts a step is divided where a run costs a few milliseconds.

    They have no measure in common with halves. None is returned where the run costs more.
    """
    whole = grid.n_steps * operations_of_step(kernel, grid.method)
    if kernel.backend != "compiled" or grid.method >= Method.CONSTRAINED or not whole:
        return None
    return next((parts for parts in _CLOSER if parts * whole <= _QUICK), None)


def window_places(n_intervals: int, count: int) -> list[int]:
    """Return the samples at which a run of so many intervals has its windows, at most ``count``.

    The last sample comes behind them.
    """
    spacing = 1
    while n_intervals // spacing + 1 > count:
        spacing *= 2
    found = list(range(0, n_intervals + 1, spacing))
    return found if found[-1] == n_intervals else [*found, n_intervals]


def window_count(kernel: Kernel, grid: StepGrid, *, by_itself: bool) -> int:
    """Return how many windows a run can afford; the same for the same run everywhere.

    One more is at its end.
    """
    each = operations_of_step(kernel, grid.method)
    afforded = _SHARE * grid.n_steps * each
    if by_itself and kernel.backend == "compiled":
        afforded = max(afforded, _FREE)
    count = math.floor(afforded / (SPENT * each + _OVERHEAD)) - 1
    return max(_LEAST_WINDOWS, min(_MOST_WINDOWS, count))
