"""What is known of a run with a fixed step when its accuracy is judged, sample by sample."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.accuracy.divergence import DivergenceError, divergence, state_limits
from vehicledyn.integrate.accuracy.proposed_step import proposed_step
from vehicledyn.integrate.accuracy.windows import (
    HALF,
    STEPS,
    UNEVEN,
    WHOLE,
    Pieces,
    StepGrid,
    WindowEnds,
    WindowStart,
    is_stuck,
    two_ends_apart,
    window_count,
)
from vehicledyn.integrate.channel_ranges import Ranges
from vehicledyn.integrate.course import RunHistory
from vehicledyn.integrate.judged_quantities import Judged
from vehicledyn.integrate.task import Sink, Statistics
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.symbolic.equations import Equations

_LATEST = 3
"""Samples before an early end of a run at which windows begin, and that of the end itself."""

_PARTS = 5, 3, 7
"""Parts of a step to try where halves do not see what uneven steps see."""

SEEN = 0.5
"""Part of what uneven steps see that others must see to serve in their place."""

KINETIC = "energy.kinetic"
"""Channel of the kinetic energy."""


@dataclass(frozen=True)
class MethodAndStep:
    """How a part of a run is taken again: method as in ``March``, and its step [s]."""

    method: int
    step: float


Rerun: TypeAlias = Callable[[WindowStart, float, int, MethodAndStep, Sink], Statistics]
"""Takes a run again from a place, so many intervals of a length [s], in another way."""


class _View(NamedTuple):
    """What of a kernel concerns the watch: judged channels, kinds of all, limits of states."""

    kernel: Kernel
    columns: NDArray[np.intp]
    kinds: NDArray[np.intp]
    limits: Vector


@dataclass
class MonitoredRun:
    """Collects what is needed to judge a run with a fixed step.

    ``equations`` are those whose channels the run delivers; the kernel may change on the way.
    ``rerun`` takes a part of the run again. ``divided`` are the parts of a step that a finer run
    takes, ``between`` is the largest kinetic energy at ends of windows [J]. ``spares`` lie half way
    between the ``places``.
    """

    equations: Equations
    grid: StepGrid
    judged: Judged
    rerun: Rerun
    divided: int = 2
    between: float = 0.0
    taken: int = 0
    places: list[WindowStart] = field(default_factory=list)
    spares: list[WindowStart] = field(default_factory=list)
    latest: list[WindowStart] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Begin with nothing known."""
        channels = self.judged.channels
        self.ranges = self.early = Ranges.of(self.equations, channels)
        self.names = [self.equations.channels[k].name for k in channels]
        self._count = self._spacing = 1
        self._view: _View | None = None
        self._ends: WindowEnds | None = None
        self._divergence = ""
        self.kept = self.judged.kept(self.grid.n_intervals)

    @property
    def kernel(self) -> Kernel:
        """The kernel that the run began with."""
        return self.places[0].kernel

    def take_past(self, kernel: Kernel, course: RunHistory | None) -> None:
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
            given = kernel.equations, times[sound:], states[sound:], limits
            self._divergence = self._words(divergence(*given, self.grid.step))
        first, self.taken = self.taken, self.taken + sound

        def place(row: int) -> WindowStart:
            copies = states[row].copy(), unknowns[row].copy()
            return WindowStart(first + row, float(times[row]), *copies, kernel)

        spacing = self._spread_out()
        span = first, self.taken
        self.places += [place(k - first) for k in _numbers(*span, spacing)]
        if spacing > 1:
            self.spares += [place(k - first) for k in _numbers(*span, spacing, spacing // 2)]
        self.latest = [*self.latest, *map(place, range(max(0, sound - _LATEST), sound))][-_LATEST:]
        if self.kept is None:
            self._measure(first, outputs[:sound, self.judged.channels])
        else:
            self.kept.take(times[:sound], outputs[:sound])
        return sound

    def measure_kept(self) -> None:
        """Find the ranges of the samples that were kept, all at once."""
        if self.kept is not None:
            self._measure(0, self.kept.values)

    def _measure(self, first: int, values: Vector) -> None:
        """Go on by judged channels, the first ones those of a sample by number."""
        of_early = max(0, self.grid.n_intervals // 2 + 1 - first)
        self.ranges.take(values[:of_early])
        if of_early:
            self.early = self.ranges.copied()
        self.ranges.take(values[of_early:])

    def _seen_as(self, kernel: Kernel, state: Vector) -> _View:
        """Return what of a kernel concerns the watch; ``state`` is its first one."""
        known = self._view
        if known is not None and known.kernel is kernel:
            return known
        e, places = kernel.equations, {c.name: k for k, c in enumerate(kernel.equations.channels)}
        limits = state_limits(state)
        if known is None:
            self._count = window_count(kernel, self.grid, by_itself=self.judged.by_itself)
        else:
            before = known.kernel.equations.states
            own = {s.name: limit for s, limit in zip(before, known.limits, strict=True)}
            limits = np.array([own.get(s.name, x) for s, x in zip(e.states, limits, strict=True)])
        columns = np.array([places.get(name, -1) for name in self.names], dtype=np.intp)
        self._view = _View(kernel, columns, self.ranges.kinds(e), limits)
        return self._view

    def _spread_out(self) -> int:
        """Return the samples between two places, of which every second one becomes a spare first.

        It doubles until all samples so far hold no more places than the run can afford.
        """
        while (self.taken - 1) // self._spacing + 1 > self._count:
            self.places, self.spares = self.places[::2], self.places[1::2]
            self._spacing *= 2
        return self._spacing

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

    def _words(self, divergence: str) -> str:
        step = self.stable_step() if self.places else None
        is_known = step is not None and step < self.grid.step
        advice = f"a step of {step * 1e3:.4g} ms" if step and is_known else "a shorter step"
        return f"{divergence}; take {advice}"

    def window(self, place: WindowStart, finer: Pieces = HALF) -> Vector | None:
        """Return how far finer steps lead from the step in the judged channels.

        Where the kernel by itself gets stuck, as in a singular configuration that the run passes in
        another way, the window half way to the next one stands for it.
        """
        one, other = self._two_ends(place, finer)
        if is_stuck(one) or is_stuck(other):
            spare = next((spare for spare in self.spares if spare.index > place.index), None)
            if spare is not None:
                place = spare
                one, other = self._two_ends(place, finer)
        _, columns, kinds, _ = self._seen_as(place.kernel, place.state)
        if one is not None:
            self.take_end(kinds, columns, one)
        apart = two_ends_apart(one, other)
        return None if apart is None else np.where(columns >= 0, apart[columns], 0.0)

    def take_end(self, kinds: NDArray[np.intp], columns: NDArray[np.intp], outputs: Vector) -> None:
        """Go on by all channels at the end of a window, whose judged ones are ``columns``."""
        self.ranges.take_likes(kinds, outputs)
        if KINETIC in self.names:
            energy = outputs[columns[self.names.index(KINETIC)]]
            self.between = max(self.between, float(energy) if np.isfinite(energy) else 0.0)

    def divide_to_see(self, place: WindowStart, channel: int) -> None:
        """Divide steps so that they move a judged channel as uneven ones do.

        Halves are left where nothing else does, or uneven steps do not get to the window's end.
        """
        ends = self._ends_of(place)
        column = self._seen_as(place.kernel, place.state).columns[channel]
        one, uneven = ends.end(place, WHOLE), ends.end(place, UNEVEN)
        if one is None or uneven is None or column < 0:
            return
        with np.errstate(all="ignore"):
            wanted = SEEN * abs(uneven[column] - one[column])
            for parts in _PARTS:
                other = ends.end(place, ((1.0, parts * STEPS),))
                if other is not None and abs(other[column] - one[column]) >= wanted:
                    self.divided = parts
                    return

    def _two_ends(self, place: WindowStart, finer: Pieces) -> tuple[Vector | None, Vector | None]:
        """Return the ends of a window with the step and with finer ones."""
        ends = self._ends_of(place)
        return ends.end(place, WHOLE), ends.end(place, finer)

    def _ends_of(self, place: WindowStart) -> WindowEnds:
        """Return what takes windows with the kernel of a place."""
        if self._ends is None or self._ends.kernel is not place.kernel:
            self._ends = WindowEnds(self.grid, place.kernel)
        return self._ends

    def stable_step(self) -> float | None:
        """Return the step that suits the motion at the start [s], None where it is not known."""
        start = self.places[0]
        point = (start.time, start.state, start.unknowns)
        try:
            return proposed_step(self.kernel, self.grid.method, point, self.grid.interval)
        except (NumericalError, np.linalg.LinAlgError):
            return None


def _numbers(first: int, stop: int, spacing: int, beyond: int = 0) -> range:
    """Return the numbers in a span that lie so far ``beyond`` multiples of ``spacing``."""
    return range(first + (beyond - first) % spacing, stop, spacing)
