"""The accuracy of a run with a fixed step: watched in short windows, judged at its end.

At samples spread over the run a few steps are taken again, with the step and with half of it.
What the two lead apart, added up over the whole run, bounds its error as long as motions do not
drive each other apart. A small bound ends the matter, for about a hundredth of the run's work.
Otherwise the run is taken again with half the step, all of it where that is cheap, else a part,
and its key figures are compared. None of this touches the run itself.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.accuracy import Accuracy
from vehicledyn.integrate.accuracy_windows import (
    SPENT,
    STEPS,
    Grid,
    Place,
    order_of,
    total_error,
    two_ends_apart,
    window_count,
    window_end,
)
from vehicledyn.integrate.channel_ranges import Ranges
from vehicledyn.integrate.course import Course
from vehicledyn.integrate.half_step_run import (
    Rerun,
    ends_without_reason,
    look_again,
    rerun_plainly,
)
from vehicledyn.integrate.judged_quantities import Judged
from vehicledyn.integrate.proposed_step import proposed_step
from vehicledyn.integrate.recommended_step import recommended_step
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.symbolic.equations import Equations

_MOST_BOUND = {1: 0.01, 2: 0.04, 4: 0.04}
"""What the errors in windows may add up to without a second look, by the order of the method.

Errors of order one have one sign throughout, and what amplifies them has all the run to do so.
"""

_MOVED = 0.04
"""What a second look may find without a warning."""

_LATEST = 3
"""Samples before an early end of a run at which windows begin, and that of the end itself."""

_HUGE = 1e12
"""State, in SI units or in its values at the start, beyond which no vehicle gets."""

_GROWN, _ERRING = 1e3, 0.05
"""Growth of a range from the first half to the whole run, with errors, that marks divergence."""


class DivergenceError(NumericalError):
    """A run that must not go on in any other way, as its step is too long."""


class _View(NamedTuple):
    """What of a kernel concerns the watch: judged channels, kinds of all, limits of states."""

    kernel: Kernel
    columns: NDArray[np.intp]
    kinds: NDArray[np.intp]
    limits: Vector


@dataclass
class AccuracyWatch:
    """Collects what is needed to judge a run with a fixed step, and judges it.

    ``equations`` are those whose channels the run delivers; the kernel may change on the way.
    ``rerun`` takes a part of the run again.
    """

    equations: Equations
    grid: Grid
    judged: Judged
    rerun: Rerun = rerun_plainly
    taken: int = 0
    places: list[Place] = field(default_factory=list)
    latest: list[Place] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Begin with nothing known."""
        channels = self.judged.channels
        self.ranges, self.early = (Ranges.of(self.equations, channels) for _ in range(2))
        self.names = [self.equations.channels[k].name for k in channels]
        self._count = self._spacing = 1
        self._view: _View | None = None
        self._divergence = ""
        self.history = self.judged.history(self.grid.n_intervals)

    @property
    def kernel(self) -> Kernel:
        """The kernel that the run began with."""
        return self.places[0].kernel

    def take_past(self, kernel: Kernel, course: Course | None) -> None:
        """Go on by the samples up to where a continued run begins, if they are known."""
        if course is None or course.beginning is None or course.beginning.past is None:
            return
        for block in course.beginning.past():
            self.take(kernel, *block)

    def take(
        self, kernel: Kernel, times: Vector, states: Vector, unknowns: Vector, outputs: Vector
    ) -> int:
        """Go on by samples, one row each, in order from the first.

        States and unknowns are those of the kernel, outputs those of ``equations``.

        Returns
        -------
        int
            How many there are before a state grows beyond all measure.
        """
        limits = self._seen_as(kernel, states[0]).limits
        beyond = ~(np.abs(states) <= limits)
        sound = int(np.argmax(beyond.any(axis=1))) if beyond.any() else len(states)
        if sound < len(states):
            self._divergence = self._words(kernel, float(times[sound]), states[sound], limits)
        first, self.taken = self.taken, self.taken + sound

        def place(row: int) -> Place:
            copies = states[row].copy(), unknowns[row].copy()
            return Place(first + row, float(times[row]), *copies, kernel)

        for index in range(-(-first // self._spacing) * self._spacing, self.taken, self._spacing):
            if index % self._spacing == 0:
                self._keep(place(index - first))
        self.latest = [*self.latest, *map(place, range(max(0, sound - _LATEST), sound))][-_LATEST:]
        values = outputs[:sound, self.judged.channels]
        self.early.take(values[: max(0, self.grid.n_intervals // 2 + 1 - first)])
        self.ranges.take(values)
        if self.history is not None:
            self.history.append((times[:sound].copy(), values))
        return sound

    def _seen_as(self, kernel: Kernel, state: Vector) -> _View:
        """Return what of a kernel concerns the watch; ``state`` is its first one."""
        known = self._view
        if known is not None and known.kernel is kernel:
            return known
        e, places = kernel.equations, {c.name: k for k, c in enumerate(kernel.equations.channels)}
        with np.errstate(over="ignore"):
            limits = _HUGE * np.maximum(1.0, np.abs(state))
        if known is None:
            self._count = window_count(kernel, self.grid, by_itself=self.judged.by_itself)
        else:
            before = known.kernel.equations.states
            own = {s.name: limit for s, limit in zip(before, known.limits, strict=True)}
            limits = np.array([own.get(s.name, x) for s, x in zip(e.states, limits, strict=True)])
        columns = np.array([places.get(name, -1) for name in self.names], dtype=np.intp)
        self._view = _View(kernel, columns, self.ranges.kinds(e), limits)
        return self._view

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

    def refuse_divergence(self) -> None:
        """Raise DivergenceError where a state has grown beyond all measure."""
        if self._divergence:
            raise DivergenceError(self._divergence)

    def _words(self, kernel: Kernel, time: float, state: Vector, limits: Vector) -> str:
        column = int(np.argmax(~(np.abs(state) <= limits)))
        grown = kernel.equations.states[column]
        step = self.stable_step() if self.places else None
        advice = "a shorter step" if step is None else f"a step of {step * 1e3:.4g} ms"
        return (
            f"state '{grown.name}' is {state[column]:.3g} {grown.unit} at t = {time:.9g} s: the "
            f"integration diverges with a step of {self.grid.step * 1e3:.4g} ms; take {advice}"
        )

    def verdict(self, *, ended_early: bool) -> Accuracy:
        """Return what is to be said of the run after its last sample.

        ``ended_early`` says that an event ended it, which a second look must confirm.

        Raises
        ------
        DivergenceError
            If the run has nothing to do with the motion.
        """
        found = self.conclude(ended_early=ended_early)
        if found.verdict == "diverged":
            raise DivergenceError(f"the integration diverged: {found.warning}")
        return found

    def conclude(self, *, ended_early: bool = False) -> Accuracy:
        """Return the same, also of a run that diverged."""
        ends = self.latest[:-1] if ended_early else self.latest[-1:]
        places = [*self.places, *(p for p in ends if p.index > self.places[-1].index)]
        rows = [self._window(place) for place in places]
        found = [(p, row) for p, row in zip(places, rows, strict=True) if row is not None]
        n_channels = len(self.names)
        with np.errstate(all="ignore"):
            errors = np.array([row for _, row in found]).reshape(len(found), n_channels)
            errors = total_error(errors, self.grid.method) / self.ranges.scales()
        errors = np.nan_to_num(errors, nan=np.inf, posinf=np.inf)
        if ended_early and (not found or ends_without_reason(self)):
            found, errors = [(self.places[0], errors)], np.full((1, n_channels), np.inf)
        return self._judge([place for place, _ in found], errors, ended_early=ended_early)

    def _window(self, place: Place) -> Vector | None:
        """Return how far half the step leads from the step in the judged channels."""
        _, columns, kinds, _ = self._seen_as(place.kernel, place.state)
        one, other = (window_end(self.grid, place, divided) for divided in (1, 2))
        if one is not None:
            self.ranges.take_likes(kinds, one)
        apart = two_ends_apart(one, other)
        return None if apart is None else np.where(columns >= 0, apart[columns], 0.0)

    def _judge(self, places: list[Place], errors: Vector, *, ended_early: bool) -> Accuracy:
        """Return what is to be said of the errors in windows, shape (n_windows, n_channels)."""
        spent = SPENT * len(places)
        bound, worst = bound_of(errors, self.taken * self.grid.per_interval)
        if bound <= most_bound(self.grid.method):
            name = f"'{self.names[worst]}'" if self.names else ""
            return Accuracy("accurate", bound, name, None, spent)
        moved = look_again(self, places, errors, ended_early=ended_early)
        spent += moved.extra_steps
        if moved.error <= _MOVED:
            return Accuracy("accurate", moved.error, moved.worst, None, spent)
        diverged = moved.goes_on or self._diverged(errors)
        advice = recommended_step(self, moved)
        return Accuracy(
            "diverged" if diverged else "inaccurate",
            moved.error,
            moved.worst,
            advice.step,
            spent + advice.extra_steps,
            advice.finest,
        )

    def _diverged(self, errors: Vector) -> bool:
        """Return whether a channel grew out of all proportion, by errors of the last window."""
        with np.errstate(all="ignore"):
            growth = self.ranges.scales() / self.early.scales()
        return bool(((growth > _GROWN) & (errors[-1] > _ERRING)).any())

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
