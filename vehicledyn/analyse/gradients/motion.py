"""Motions with fixed steps and their derivatives by parameters and start values.

The derivatives are those of what the steps compute, to rounding: tangents of every stage, through
the solved constraints, and through events, whose instants move with the parameters:

    dt/dp = -(dg/dp) / (dg/dt)

for an event function g that a step reaches at the instant t. A step up to an event is one of
variable length, and so is the one behind it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.events import EventWatch, Point
from vehicledyn.kernel.engine import Count, Ledger, March, Method, Rows, Status, Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.tangent_code import Bundle, Grid, Moment, TangentCode, Way

Matrix = NDArray[np.float64]

_GRAZING = 1e-6
"""Rate of an event function at its zero, as a part of its mean rate in the step before it."""

_SHORTEST, _REACH = 1e-9, 1.25
"""Parts of a step behind an event of a method of order one, as in a run without derivatives."""


@dataclass(frozen=True)
class EventSlope:
    """An event: its name, its instant [s], and that one's derivatives (n_directions,)."""

    name: str
    time: float
    slope: Vector


@dataclass
class MotionSlopes:
    """A motion and its derivatives by n directions.

    ``times`` (n_times,), ``values`` (n_times, n_channels), ``slopes`` (n_times, n_channels,
    n_directions) of the chosen channels, ``state`` and ``state_slopes`` (n_states, n_directions)
    at the end, ``events`` in their order. Where an event ended the run, the last sample moves with
    it.
    """

    times: Vector
    values: Matrix
    slopes: Matrix
    state: Vector
    state_slopes: Matrix
    events: list[EventSlope]
    ended_by: str


@dataclass
class _Recorder:
    n_channels: int
    n_directions: int
    times: list[float] = field(default_factory=list)
    values: list[Vector] = field(default_factory=list)
    slopes: list[Matrix] = field(default_factory=list)

    def take(self, time: float, values: Vector, slopes: Matrix) -> None:
        self.times.append(time)
        self.values.append(values[: self.n_channels])
        self.slopes.append(slopes[: self.n_channels, : self.n_directions])


def follow(
    code: TangentCode,
    kernel: Kernel,
    grid: Grid,
    *,
    n_intervals: int,
    start: tuple[Vector, Vector],
    directions: tuple[Matrix, Matrix],
    progress: Callable[[float], object] | None = None,
) -> MotionSlopes:
    """Return a motion and its derivatives.

    Parameters
    ----------
    code
        Compiled derivatives of the kernel's equations.
    kernel
        The model with its parameters.
    grid, n_intervals
        The fixed steps, and how many sampling intervals.
    start
        States and unknowns at the start.
    directions
        Tangents of the parameters (n_parameters, n_directions) and of the states at the start
        (n_states, n_directions).
    progress
        Called with the part done.

    Raises
    ------
    NumericalError
        If the run cannot go on, or a derivative does not exist.
    """
    run = _Run(code, kernel, grid, start, directions)
    run.sample()
    for number in range(n_intervals):
        run.interval()
        if run.watch.ended_by:
            break
        if progress is not None:
            progress((number + 1) / n_intervals)
    record = run.record
    return MotionSlopes(
        np.array(record.times),
        np.array(record.values),
        np.array(record.slopes),
        run.march.state.copy(),
        run.bundle.state[:, : run.n],
        run.events,
        run.watch.ended_by,
    )


def sampled_run(
    kernel: Kernel, grid: Grid, n_intervals: int, start: tuple[Vector, Vector]
) -> tuple[Vector, Matrix, Vector]:
    """Return times, all channels (n_times, n_channels) and the last state of a plain run.

    Raises
    ------
    NumericalError
        If it cannot go on.
    """
    e = kernel.equations
    unknowns = kernel.solve_unknowns(grid.start, *start)
    march = March(grid.method, grid.start, grid.interval, grid.per_interval, start[0], unknowns)
    sizes = (len(e.states), len(e.unknowns), len(e.channels))
    rows = Rows(*[np.empty((n_intervals + 1, size)) for size in sizes])
    first = kernel.outputs(grid.start, start[0], unknowns)
    status = kernel.advance(march, n_intervals * grid.per_interval, rows)
    if status is not Status.SOLVED:
        time = march.time(march.step)
        raise NumericalError(kernel.failure(status, time, march.ledger))
    times = np.asarray(grid.start + grid.interval * np.arange(n_intervals + 1), dtype=float)
    return times, np.vstack([first, rows.outputs[:n_intervals]]), march.state.copy()


class _Run:
    """A motion under way: the run itself, and a bundle of tangents that follows it.

    With events the last direction of the bundle is the length of the step under way.
    """

    def __init__(
        self,
        code: TangentCode,
        kernel: Kernel,
        grid: Grid,
        start: tuple[Vector, Vector],
        directions: tuple[Matrix, Matrix],
    ) -> None:
        by_parameter, by_state = directions
        self.code, self.kernel, self.grid, self.n = code, kernel, grid, by_state.shape[1]
        self.events: list[EventSlope] = []
        self.record = _Recorder(len(code.channels), self.n)
        self.constants = code.constants(kernel.parameters)
        moved = np.asarray(code.constant_slopes(kernel.parameters) @ by_parameter)
        extra = bool(kernel.equations.events)
        self.bundle = Bundle(code, np.pad(moved, ((0, 0), (0, int(extra)))))
        self.bundle.state = np.pad(by_state, ((0, 0), (0, int(extra))))
        self._extra = np.zeros(self.n + int(extra))
        state, guess = start
        unknowns = code.solved(grid.start, state, guess, self.constants)
        self._names: list[str] = []
        self.watch = EventWatch(
            kernel, Point(grid.start, state, unknowns), Ledger(), self._happened
        )
        sides = self.watch.sides
        self.march = March(
            grid.method, grid.start, grid.interval, grid.per_interval, state, unknowns, sides=sides
        )
        shape = (2, len(state)), (2, len(unknowns)), (2, len(kernel.equations.channels))
        self._rows = Rows(*[np.empty(item) for item in shape])
        if self.watch.ended_by:
            raise NumericalError(f"event '{self.watch.ended_by}' ends the motion at its start")

    def _happened(self, name: str, _: float) -> None:
        self._names.append(name)

    @property
    def time(self) -> float:
        """Time of the step that is due [s]."""
        return self.march.time(self.march.step)

    def sample(self, moved: Vector | None = None) -> None:
        """Record the channels at the point reached; ``moved`` are the tangents of its time."""
        values, slopes = self._values(
            Point(self.time, self.march.state, self.march.unknowns), moved
        )
        self.record.take(self.time, values, slopes)

    def _values(self, point: Point, moved: Vector | None) -> tuple[Vector, Matrix]:
        moment = Moment(*point, self.constants)
        self.bundle.point(moment, moved)
        return self.bundle.values(moment, moved)

    def interval(self) -> None:
        """Go on to the next sample, or to the event that ends the motion."""
        due = self.grid.per_interval
        while due:
            state, unknowns, first = (
                self.march.state.copy(),
                self.march.unknowns.copy(),
                self.march.step,
            )
            status = self.kernel.advance(self.march, due, self._rows)
            taken = int(self.march.ledger.counts[Count.STEPS])
            moment = Moment(self.time, state, unknowns, self.constants)
            self.bundle.steps(self.grid, Way(first, taken), moment)
            due -= taken
            if status is Status.EVENT:
                self._step_with_events()
                if self.watch.ended_by:
                    return
                due -= 1
            elif status is not Status.SOLVED:
                raise NumericalError(self.kernel.failure(status, self.time, self.march.ledger))
        self.sample()

    def _step_with_events(self) -> None:
        """Take the step that is due in parts, as a run without derivatives does."""
        step = self.grid.interval / self.grid.per_interval
        fraction, reach, moved = 0.0, 1.0, self._extra.copy()
        euler = self.grid.method == Method.SYMPLECTIC_EULER
        while fraction < 1.0 and not self.watch.ended_by:
            begin, end = fraction, min(fraction + reach, 1.0)
            trial, self._names = self._trials(begin), []
            point = trial(end)
            crosses = self.watch.fires(point)
            if crosses:
                fraction, point = self.watch.cross(trial, begin, end, step)
                before = trial(fraction)
                moved = self._cross(before, point, begin, fraction, moved)
                reach = _SHORTEST / step if euler else 1.0
            else:
                self.watch.passed(point)
                later = self._extra if end == 1.0 else moved
                self._part((begin, end), (moved, later))
                fraction, reach = end, _REACH * reach
                moved = later
            self.march.state[:], self.march.unknowns[:] = point.state, point.unknowns
        self.march.memory[:] = 0.0
        self.march.step += 1
        if self.watch.ended_by:
            self._end(point, moved)

    def _end(self, point: Point, moved: Vector) -> None:
        """Record the sample where a terminal event ends the motion."""
        values, slopes = self._values(point, moved)
        self.record.take(point.time, values, slopes)

    def _trials(self, begin: float) -> Callable[[float], Point]:
        def trial(end: float) -> Point:
            part = replace(self.march)
            status = self.kernel.advance_part(part, (begin, end))
            if status is not Status.SOLVED:
                moment = self.march.time(self.march.step, begin)
                raise NumericalError(self.kernel.failure(status, moment, self.march.ledger))
            step = self.march.step
            moment = self.march.time(step, end) if end < 1.0 else self.march.time(step + 1)
            return Point(moment, part.state, part.unknowns)

        return trial

    def _part(self, span: tuple[float, float], times: tuple[Vector, Vector]) -> None:
        state, unknowns = self.march.state.copy(), self.march.unknowns.copy()
        moment = Moment(self.time, state, unknowns, self.constants)
        self.bundle.steps(self.grid, Way(self.march.step, 1, span), moment, times)

    def _cross(
        self, before: Point, after: Point, begin: float, end: float, moved: Vector
    ) -> Vector:
        """Carry the tangents through the events at a point; return those of its time."""
        known = self._names
        all_events = [event.name for event in self.kernel.equations.events]
        places = [all_events.index(name) for name in known]
        self._refuse_coincidence(places, before.time)
        earlier = self.kernel.event_values(
            self.march.time(self.march.step, begin), self.march.state, self.march.unknowns
        )
        ahead = self._extra.copy()
        ahead[-1] = 1.0
        self._part((begin, end), (moved, ahead))
        _, slopes = self._values(before, ahead)
        n_channels = len(self.code.channels)
        by_event = slopes[n_channels + places[0]]
        rate = by_event[-1]
        seconds = before.time - self.march.time(self.march.step, begin)
        if not abs(rate) * seconds > _GRAZING * abs(earlier[places[0]]):
            raise NumericalError(
                f"event '{known[0]}' only grazes its limit at t = {before.time:.9g} s: a smaller "
                "motion would miss it, so no derivative exists behind it; change the parameters "
                "or end the run before"
            )
        moment = np.append(-by_event[:-1] / rate, 0.0)
        self.events += [EventSlope(name, before.time, moment[:-1].copy()) for name in known]
        tangents = self.bundle.state
        tangents = tangents + np.outer(tangents[:, -1], moment)
        tangents[:, -1] = 0.0
        event = self.kernel.equations.events[places[0]]
        first = n_channels + len(all_events)
        total = slopes + np.outer(slopes[:, -1], moment)
        for index, row in event.resets:
            tangents[index] = total[first + row]
            tangents[index, -1] = 0.0
        self.bundle.state = tangents
        return moment

    def _refuse_coincidence(self, places: list[int], time: float) -> None:
        events = [self.kernel.equations.events[k] for k in places]
        if len(events) > 1 and any(event.resets for event in events):
            names = " and ".join(f"'{event.name}'" for event in events)
            raise NumericalError(
                f"the events {names} happen at once at t = {time:.9g} s: which comes first "
                "decides how the motion goes on, so no derivative exists behind them"
            )


@dataclass(frozen=True)
class Balance:
    """An equilibrium: all parameters, time [s], states and unknowns, and what was balanced.

    ``pairs`` are the states that were free and the rates that are zero.
    """

    parameters: Vector
    time: float
    point: tuple[Vector, Vector]
    pairs: tuple[list[int], list[int]]


def start_slopes(
    code: TangentCode, balance: Balance, by_parameter: Matrix, held: Matrix | None = None
) -> Matrix:
    """Return the derivatives of an equilibrium's states, shape (n_states, n_directions).

    0 = f_b(x, p) for the balanced rates b and the free states: dx = -(∂f_b/∂x)⁻¹ df_b.

    Parameters
    ----------
    code
        Compiled derivatives.
    balance
        The equilibrium.
    by_parameter
        Tangents of the parameters, shape (n_parameters, n_directions).
    held
        Tangents of the states that are not free, shape (n_states, n_directions).

    Raises
    ------
    NumericalError
        If the equilibrium does not follow the parameters.
    """
    free, balanced = balance.pairs
    slopes = np.zeros((len(balance.point[0]), by_parameter.shape[1])) if held is None else held
    slopes = slopes.copy()
    slopes[free] = 0.0
    rates = rate_slopes(code, balance, by_parameter)
    by_free, given = rates[0][np.ix_(balanced, free)], (rates[1] + rates[0] @ slopes)[balanced]
    found = -np.linalg.lstsq(by_free, given, rcond=1e-12)[0]
    missed = np.abs(by_free @ found + given)
    if np.any(missed > 1e-7 * np.max(np.abs(given), axis=0, initial=1e-12)):
        raise NumericalError("the equilibrium has no derivative: it is not isolated")
    slopes[free] = found
    return slopes


def rate_slopes(code: TangentCode, balance: Balance, by_parameter: Matrix) -> tuple[Matrix, Matrix]:
    """Return dẋ/dx (n_states, n_states) and dẋ/dp (n_states, n_directions) on closed loops."""
    state, guess = (np.ascontiguousarray(item) for item in balance.point)
    n = len(state)
    constants = code.constants(balance.parameters)
    moved = np.asarray(code.constant_slopes(balance.parameters) @ by_parameter)
    bundle = Bundle(code, np.hstack([np.zeros((len(moved), n)), moved]))
    bundle.state = np.hstack([np.eye(n), np.zeros((n, by_parameter.shape[1]))])
    unknowns = code.solved(balance.time, state, guess, constants)
    found: Any = bundle.point(Moment(balance.time, state, unknowns, constants))[2]
    return found[:, :n], found[:, n:]
