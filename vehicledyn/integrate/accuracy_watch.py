"""The accuracy of a run with a fixed step: watched in short windows, judged at its end.

At samples spread over the run a few steps are taken again, with the step and with half of it.
What the two lead apart, added up over the whole run, bounds its error as long as motions do not
drive each other apart. A small bound ends the matter, for less than a hundredth of the run's work.
Otherwise the run is taken again with half the step, all of it where that is cheap, else a part,
and its key figures are compared. None of this touches the run itself.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.accuracy_windows import (
    STEPS,
    Grid,
    Place,
    operations_of_step,
    order_of,
    total_error,
    window_difference,
)
from vehicledyn.integrate.channel_ranges import Ranges
from vehicledyn.integrate.half_step_run import Moved, ends_without_reason, look_again, settled_step
from vehicledyn.integrate.judged_quantities import Judged
from vehicledyn.integrate.proposed_step import dividing_step, proposed_step
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.kernel import Kernel

_MOST_BOUND = {1: 0.01, 2: 0.04, 4: 0.04}
"""What the errors in windows may add up to without a second look, by the order of the method.

Errors of order one have one sign throughout, and what amplifies them has all the run to do so.
"""

_MOVED = 0.04
"""What a second look may find without a warning."""

_AIM, _ASYMPTOTIC = 0.01, 0.2
"""Error that the recommended step is to have, and the largest from which it can be foretold."""

_SHARE, _LEAST_WINDOWS, _MOST_WINDOWS = 0.01, 2, 16
_OVERHEAD, _FREE = 6e5, 2.4e7
"""Operations that calling a window costs, and that a run by itself may always spend on them."""

_LATEST = 3
"""Samples before an early end of a run at which windows begin, and that of the end itself."""

_HUGE = 1e12
"""State, in SI units or in its values at the start, beyond which no vehicle gets."""

_GROWN, _ERRING = 1e3, 0.05
"""Growth of a range from the first half to the whole run, with errors, that marks divergence."""


@dataclass(frozen=True)
class Accuracy:
    """What the watch found.

    ``verdict`` is "accurate", "inaccurate" or "diverged"; ``error`` the estimated error of the
    worst key figure or channel, ``worst``, as a part of its size; ``step`` the one to take instead
    [s], None where the present one will do; ``extra_steps`` were taken to find out.
    """

    verdict: str
    error: float
    worst: str
    step: float | None = None
    extra_steps: int = 0

    @property
    def warning(self) -> str:
        """A sentence for a person; empty for an accurate run."""
        if self.verdict == "accurate":
            return ""
        advice = "" if self.step is None else f"; take a step of {self.step * 1e3:.4g} ms"
        if not self.worst:
            return f"the run ends early only because its step is too long{advice}"
        size = f"about {100.0 * self.error:.2g} %" if self.error < 1.0 else "its own size or more"
        return f"the step is too long: {self.worst} is off by {size}{advice}"

    def as_attributes(self) -> dict[str, str | float | int | None]:
        """Return what a result file keeps of it, by name."""
        return {
            "accuracy": self.verdict,
            "estimated_error": self.error,
            "least_accurate": self.worst.strip("'"),
            "recommended_step": self.step,
            "accuracy_steps": self.extra_steps,
        }


def worst_of(parts: Sequence[Accuracy | None]) -> Accuracy | None:
    """Return what is to be said of a run in parts, None where nothing is known of any."""
    known = [part for part in parts if part is not None]
    if not known:
        return None
    worst = max(known, key=lambda part: (part.verdict != "accurate", part.error))
    steps = [part.step for part in known if part.step is not None]
    extra = sum(part.extra_steps for part in known)
    return replace(worst, step=min(steps, default=None), extra_steps=extra)


@dataclass
class AccuracyWatch:
    """Collects what is needed to judge a run with a fixed step, and judges it."""

    kernel: Kernel
    grid: Grid
    judged: Judged
    taken: int = 0
    places: list[Place] = field(default_factory=list)
    latest: list[Place] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Begin with nothing known."""
        equations, channels = self.kernel.equations, self.judged.channels
        self.ranges, self.early = (Ranges.of(equations, channels) for _ in range(2))
        self._count = window_count(self.kernel, self.grid, by_itself=self.judged.by_itself)
        self._spacing = 1
        self._limits: Vector | None = None
        self.history = self.judged.history(self.grid.n_intervals)

    def take(self, times: Vector, states: Vector, unknowns: Vector, outputs: Vector) -> int:
        """Go on by samples, one row each, in order from the first.

        Returns
        -------
        int
            How many there are before a state grows beyond all measure.
        """
        if self._limits is None:
            with np.errstate(over="ignore"):
                self._limits = _HUGE * np.maximum(1.0, np.abs(states[0]))
        beyond = ~(np.abs(states) <= self._limits)
        sound = int(np.argmax(beyond.any(axis=1))) if beyond.any() else len(states)
        first, self.taken = self.taken, self.taken + sound
        for index in range(-(-first // self._spacing) * self._spacing, self.taken, self._spacing):
            if index % self._spacing == 0:
                self._keep(_place(index, index - first, times, states, unknowns))
        for row in range(max(0, sound - _LATEST), sound):
            self.latest.append(_place(first + row, row, times, states, unknowns))
        self.latest = self.latest[-_LATEST:]
        values = outputs[:sound, self.judged.channels]
        self.early.take(values[: max(0, self.grid.n_intervals // 2 + 1 - first)])
        self.ranges.take(values)
        if self.history is not None:
            self.history.append((times[:sound].copy(), values))
        return sound

    def _keep(self, place: Place) -> None:
        """Keep a place; where there are too many, only every second one."""
        self.places.append(place)
        while len(self.places) > self._count:
            self.places, self._spacing = self.places[::2], 2 * self._spacing

    def hint(self) -> str:
        """Return a few words on the step for a run that failed; empty where it is short enough.

        A case among many says the same in a lane, where nothing is known of the step.
        """
        step = self.stable_step() if self.places and self.judged.by_itself else None
        if step is None or step >= self.grid.step:
            return ""
        return (
            f"; the step of {self.grid.step * 1e3:.4g} ms is too long for the motion at the start, "
            f"take {step * 1e3:.4g} ms"
        )

    def divergence(self, time: float, state: Vector) -> str:
        """Return a sentence about a state that has grown beyond all measure at a time [s]."""
        column = int(np.argmax(~(np.abs(state) <= self._limits)))
        grown = self.kernel.equations.states[column]
        step = self.stable_step()
        advice = "a shorter step" if step is None else f"a step of {step * 1e3:.4g} ms"
        return (
            f"state '{grown.name}' is {state[column]:.3g} {grown.unit} at t = {time:.9g} s: the "
            f"integration diverges with a step of {self.grid.step * 1e3:.4g} ms; take {advice}"
        )

    def conclude(self, *, ended_early: bool = False) -> Accuracy:
        """Return what is to be said of the run after its last sample.

        ``ended_early`` says that an event ended it, which a second look must confirm.
        """
        ends = self.latest[:-1] if ended_early else self.latest[-1:]
        places = [*self.places, *(p for p in ends if p.index > self.places[-1].index)]
        channels = self.judged.channels
        rows = [window_difference(self.kernel, self.grid, place) for place in places]
        found = [(p, row[channels]) for p, row in zip(places, rows, strict=True) if row is not None]
        with np.errstate(all="ignore"):
            errors = np.array([row for _, row in found]).reshape(len(found), len(channels))
            errors = total_error(errors, self.grid.method) / self.ranges.scales()
        errors = np.nan_to_num(errors, nan=np.inf, posinf=np.inf)
        if ended_early and (not found or ends_without_reason(self)):
            found, errors = [(self.places[0], errors)], np.full((1, len(channels)), np.inf)
        return self.judge([place for place, _ in found], errors, ended_early=ended_early)

    def judge(self, places: list[Place], errors: Vector, *, ended_early: bool) -> Accuracy:
        """Return what is to be said of the errors in windows, shape (n_windows, n_channels)."""
        spent = 3 * STEPS * len(places)
        bound, worst = bound_of(errors, self.taken * self.grid.per_interval)
        if bound <= most_bound(self.grid.method):
            names = [self.kernel.equations.channels[k].name for k in self.judged.channels]
            return Accuracy("accurate", bound, f"'{names[worst]}'" if names else "", None, spent)
        moved = look_again(self, places, errors, ended_early=ended_early)
        spent += moved.extra_steps
        if moved.error <= _MOVED:
            return Accuracy("accurate", moved.error, moved.worst, None, spent)
        diverged = moved.goes_on or self._diverged(errors)
        verdict = "diverged" if diverged else "inaccurate"
        step, more = self._recommended(moved)
        return Accuracy(verdict, moved.error, moved.worst, step, spent + more)

    def _diverged(self, errors: Vector) -> bool:
        """Return whether a channel grew out of all proportion, by errors of the last window."""
        with np.errstate(all="ignore"):
            growth = self.ranges.scales() / self.early.scales()
        return bool(((growth > _GROWN) & (errors[-1] > _ERRING)).any())

    def _recommended(self, moved: Moved) -> tuple[float, int]:
        """Return the step to take [s], and the steps it took to find it.

        By the method's order where the error is small enough for that; else the longest halved
        step that is found to be accurate, or what the motion at the start needs.
        """
        longest, spent = 0.5 * self.grid.step, 0
        if moved.error < _ASYMPTOTIC:
            order = order_of(self.grid.method)
            longest = min(longest, self.grid.step * (_AIM / moved.error) ** (1.0 / order))
            return dividing_step(longest, self.grid.interval), spent
        step = None
        if not moved.goes_on:
            step, spent = settled_step(self, _AIM)
        if step is None:
            stable = self.stable_step()
            step = dividing_step(min(longest, stable or longest), self.grid.interval)
        return step, spent

    def stable_step(self) -> float | None:
        """Return the step that suits the motion at the start [s], None where it is not known."""
        start = self.places[0]
        point = (start.time, start.state, start.unknowns)
        try:
            return proposed_step(self.kernel, self.grid.method, point, self.grid.interval)
        except (NumericalError, np.linalg.LinAlgError):
            return None


def most_bound(method: int) -> float:
    """Return what errors in windows may add up to without a second look, as a part of a range."""
    return _MOST_BOUND[order_of(method)]


def bound_of(errors: Vector, n_steps: int) -> tuple[float, int]:
    """Return what errors in windows add up to in all steps of a run.

    ``errors`` have the shape (n_windows, n_channels). Returned are the largest bound of any channel
    and the number of that channel.
    """
    if not errors.size:
        return 0.0, 0
    bounds = errors.mean(axis=0) * max(1.0, n_steps / STEPS)
    worst = int(np.argmax(bounds))
    return float(bounds[worst]), worst


def _place(index: int, row: int, times: Vector, states: Vector, unknowns: Vector) -> Place:
    return Place(index, float(times[row]), states[row].copy(), unknowns[row].copy())


def window_places(n_intervals: int, count: int) -> list[int]:
    """Return the samples at which a run of so many intervals has its windows, at most ``count``.

    The last sample comes behind them.
    """
    spacing = 1
    while n_intervals // spacing + 1 > count:
        spacing *= 2
    found = list(range(0, n_intervals + 1, spacing))
    return found if found[-1] == n_intervals else [*found, n_intervals]


def window_count(kernel: Kernel, grid: Grid, *, by_itself: bool) -> int:
    """Return how many windows a run can afford; the same for the same run everywhere."""
    each = operations_of_step(kernel, grid.method)
    afforded = _SHARE * grid.n_steps * each
    if by_itself and kernel.backend == "compiled":
        afforded = max(afforded, _FREE)
    count = math.floor(afforded / (3 * STEPS * each + _OVERHEAD))
    return max(_LEAST_WINDOWS, min(_MOST_WINDOWS, count))
