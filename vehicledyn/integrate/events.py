"""Find the events of a run, let them happen and report them; every method uses this.

A method watches its own points, as close together as it steps: an event whose function changes
sign and back between two of them is missed. Where one fires, the method makes trial points in
between, from which :meth:`EventMonitor.cross` finds the first point behind the sign change; the
motion starts anew from there.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.engine import Ledger, Sides, Vector
from vehicledyn.kernel.event_signs import fired, note_sides
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.symbolic.equations import Event

_RESOLUTION = 1e-12
"""Bracket of an event when it counts as found [s]; late in a run some units of rounding."""

_LOOK_AHEAD = 1000.0
"""How far behind an event its function shows the side, in brackets of that width.

Nothing is watched up to there: what the event left of its function may have either sign.
"""

_SHORT = 1e-6
"""An event that fires for the third time within two of these [s] is taken to accumulate.

A ball that bounces at such intervals rises by 1e-12 m, little above what rounding leaves.
"""

_MOST_TRIALS = 200


class ConsistentPoint(NamedTuple):
    """A time with consistent state and unknowns."""

    time: float
    state: Vector
    unknowns: Vector


Trial = Callable[[float], ConsistentPoint]
"""Gives the point at a fraction of a stretch of the motion without events."""


class EventMonitor:
    """The sides on which the functions of the events lie, as a run goes on.

    ``sides`` holds a sign for each event; zero says that nothing is known yet. It is changed in
    place. ``ended_by`` names the terminal event that ended the run, once there is one.
    """

    def __init__(
        self,
        kernel: Kernel,
        start: ConsistentPoint,
        ledger: Ledger,
        happened: Callable[[str, float], None],
    ) -> None:
        """Take the sides at the start; an event whose function is zero there does not fire.

        Terminal events that give advice bound what the model can do: a start that lies beyond one
        ends the run at once.
        """
        self._kernel, self._ledger, self._happened = kernel, ledger, happened
        self._events = kernel.equations.events
        self.sides: Sides = np.zeros(len(self._events), dtype=np.intc)
        self.count = 0
        self.ended_by = ""
        self._blind_until = -np.inf
        self._recent = np.full((len(self._events), 2), -np.inf)
        if self._events:
            values = self._values(start)
            note_sides(self.sides, values)
            self._look_ahead(start, values == 0.0)
            self._end_beyond(start.time, values)

    @property
    def memory(self) -> Vector:
        """What is known beyond the sides: count, and when events were last crossed [s]."""
        return np.array([self.count, self._blind_until, *self._recent.ravel()])

    def recall(self, memory: Vector) -> None:
        """Set what :attr:`memory` returned."""
        self.count, self._blind_until = int(memory[0]), float(memory[1])
        self._recent = memory[2:].reshape(self._recent.shape).copy()

    @property
    def blind_until(self) -> float:
        """Time up to which nothing is watched [s]."""
        return float(self._blind_until)

    @property
    def active(self) -> bool:
        """Whether there is anything to watch."""
        return bool(self._events)

    def fires(self, point: ConsistentPoint) -> bool:
        """Return whether an event fires up to a point; where none does, go on to it."""
        if point.time < self._blind_until:
            return False
        values = self._values(point)
        if fired(self._events, self.sides, values).any():
            return True
        note_sides(self.sides, values)
        return False

    def cross(
        self, trial: Trial, begin: float, end: float, seconds: float
    ) -> tuple[float, ConsistentPoint]:
        """Find the events that fire first and let them happen.

        Parameters
        ----------
        trial
            Gives the points of the motion.
        begin, end
            Fractions: nothing fires up to the first, something up to the second.
        seconds
            Time from fraction 0 to fraction 1 [s].

        Returns
        -------
        fraction, point
            Where the events fired, and the point from which the motion goes on.

        Raises
        ------
        NumericalError
            If an event fires again and again, or the unknowns after a reset have no solution.
        """
        fraction, point, fires = self._locate(trial, begin, end, seconds)
        return fraction, self._happen(point, fires)

    def just_behind(self, point: ConsistentPoint) -> ConsistentPoint:
        """Return a point later by the resolution of time, where forces that begin at it act.

        A force that begins where an event is may not act there yet, as a condition with ``>`` says;
        methods that take the force at the start of a step for a part of the step would miss it.
        """
        return self._later(point, _resolution(point.time))

    def _end_beyond(self, time: float, values: Vector) -> None:
        for event, value in zip(self._events, values, strict=True):
            beyond = value < 0.0 if event.direction == "falling" else value > 0.0
            if event.terminal and event.advice and event.direction != "either" and beyond:
                self.count += 1
                self._happened(event.name, time)
                self.ended_by = self.ended_by or event.name

    def _values(self, point: ConsistentPoint) -> Vector:
        return self._kernel.event_values(*point)

    def _locate(
        self, trial: Trial, begin: float, end: float, seconds: float
    ) -> tuple[float, ConsistentPoint, NDArray[np.bool_]]:
        """Narrow the bracket by secants that give way to halves (Illinois method)."""
        low, high, point = begin, end, trial(end)
        below, above = self._values(trial(begin)), self._values(point)
        fires = fired(self._events, self.sides, above)
        width = _resolution(point.time) / seconds
        moved_high, halve, size = False, False, high - low
        for _ in range(_MOST_TRIALS):
            if high - low <= width:
                break
            guess = _middle(low, high) if halve else _secant(low, high, below[fires], above[fires])
            guess = min(max(guess, low + 0.5 * width), high - 0.5 * width)
            if not low < guess < high:
                break
            middle = trial(guess)
            values = self._values(middle)
            fires_there = fired(self._events, self.sides, values)
            if fires_there.any():
                below = below * 0.5 if moved_high else below
                high, above, point, fires, moved_high = guess, values, middle, fires_there, True
            else:
                above = above if moved_high else above * 0.5
                low, below, moved_high = guess, values, False
            halve, size = high - low > 0.5 * size, high - low
        return high, point, fires | self._follow_at_once(point)

    def _follow_at_once(self, point: ConsistentPoint) -> NDArray[np.bool_]:
        """Return which events fire within the resolution of a point: they are simultaneous."""
        if len(self._events) == 1:
            return np.zeros(1, dtype=bool)
        behind = self._later(point, _resolution(point.time))
        return fired(self._events, self.sides, self._values(behind))

    def _happen(self, point: ConsistentPoint, fires: NDArray[np.bool_]) -> ConsistentPoint:
        """Report the events that fire, in their order, and apply their resets."""
        before = point
        for k in np.flatnonzero(fires):
            event = self._events[k]
            self._check_accumulation(int(k), point.time)
            self.count += 1
            self._happened(event.name, point.time)
            point = self._reset(point, event)
            self.ended_by = self.ended_by or (event.name if event.terminal else "")
        self._blind_until = point.time + _LOOK_AHEAD * _resolution(point.time)
        if self.ended_by:
            return point
        if point is before:
            crossed = -self.sides[fires]
            note_sides(self.sides, self._values(point))
            self.sides[fires] = crossed
        else:
            self.sides[:] = 0
            note_sides(self.sides, self._values(point))
            self._look_ahead(point, fires)
        return point

    def _reset(self, point: ConsistentPoint, event: Event) -> ConsistentPoint:
        if not event.resets and not event.guesses:
            return point
        values = self._kernel.reset_values(*point)
        state = point.state.copy()
        for index, row in event.resets:
            state[index] = values[row]
            if not np.isfinite(values[row]):
                name = self._kernel.equations.states[index].name
                raise NumericalError(
                    f"event '{event.name}' gives the state '{name}' no finite value at t = "
                    f"{point.time:.9g} s; what it demands of the rates may be impossible there"
                )
        guess = point.unknowns.copy()
        for index, row in event.guesses:
            guess[index] = values[row]
        unknowns = self._kernel.count_solve(point.time, state, guess, self._ledger)
        return ConsistentPoint(point.time, state, unknowns)

    def _look_ahead(self, point: ConsistentPoint, which: NDArray[np.bool_]) -> None:
        """Take the side of some functions from a point a little later, where they left zero."""
        if not which.any():
            return
        values = self._values(self._later(point, _LOOK_AHEAD * _resolution(point.time)))
        self.sides[which] = np.sign(values[which]).astype(np.intc)

    def _later(self, point: ConsistentPoint, seconds: float) -> ConsistentPoint:
        """Return a point so little later that the rates do not change until then."""
        time, unknowns = point.time + seconds, point.unknowns.copy()
        state = np.ascontiguousarray(point.state)
        state = state + seconds * self._kernel.evaluate(time, state, unknowns, self._ledger)
        return ConsistentPoint(
            time, state, self._kernel.count_solve(time, state, unknowns, self._ledger)
        )

    def _check_accumulation(self, index: int, time: float) -> None:
        if time - self._recent[index, 0] < 2.0 * _SHORT:
            raise NumericalError(
                f"event '{self._events[index].name}' fires for the third time within "
                f"{2.0 * _SHORT:g} s at t = {time:.9g} s: its instants accumulate, as those of a "
                "ball that comes to rest; let its reset also set a state of rate zero that holds "
                "the motion, or make it terminal"
            )
        self._recent[index] = self._recent[index, 1], time


def _resolution(time: float) -> float:
    return max(_RESOLUTION, 8.0 * float(np.finfo(float).eps) * abs(time))


def _middle(low: float, high: float) -> float:
    return low + 0.5 * (high - low)


def _secant(low: float, high: float, below: Vector, above: Vector) -> float:
    """Return the first zero of straight lines; the middle where a value changes no sign."""
    opposite = below * above < 0.0
    if not opposite.all():
        return _middle(low, high)
    return float(np.min(low + (high - low) * below / (below - above)))
