"""The step that would make an inaccurate run accurate, or the finding that none does."""

from __future__ import annotations

import math
from dataclasses import dataclass

from vehicledyn.integrate.accuracy.half_step_run import (
    Moved,
    RepeatedPart,
    apart,
    intervals_of,
    may_be_taken,
    taken_again,
)
from vehicledyn.integrate.accuracy.monitored_run import MethodAndStep, MonitoredRun
from vehicledyn.integrate.accuracy.proposed_step import dividing_step
from vehicledyn.integrate.accuracy.windows import order_of

_AIM, _ASYMPTOTIC = 0.01, 0.2
"""Error that the recommended step is to have, and the largest from which it can be foretold."""

_NEAR_AIM = 0.02
"""Error that is good enough for a step that was foretold."""

_MOST_HALVINGS = 10
"""How often a step is halved to find one that is short enough."""

_SETTLING = 0.75
"""Part of the error that half the step must leave, on average, for shorter steps to help."""

_FEWEST = 3
"""Halvings that must have been tried before shorter steps are said not to help."""


@dataclass(frozen=True)
class Advice:
    """The step to take [s], None where none is known; ``finest`` as in ``Accuracy``."""

    step: float | None
    extra_steps: int = 0
    finest: float | None = None


def recommended_step(watch: MonitoredRun, moved: Moved) -> Advice:
    """Return the step that brings the error of a run below a hundredth.

    It begins from the step that the method's order foretells where the error is small enough for
    that, else from half the step, or the part of it that sees what halves do not, and halves it
    until half of that moves no figure any more. Where that would cost too much, the foretold step
    stands, or what the motion at the start needs.

    Parameters
    ----------
    watch
        The run.
    moved
        How far it moves with half its step.
    """
    grid, longest, foretold = watch.grid, watch.grid.step / watch.divided, None
    if moved.error < _ASYMPTOTIC and watch.divided == 2:
        ratio = (_AIM / moved.error) ** (1.0 / order_of(grid.method))
        foretold = dividing_step(min(longest, grid.step * ratio), grid.interval)
    begin = foretold or (dividing_step(longest, grid.interval) if watch.divided == 2 else longest)
    tried = _Halvings(watch, begin)
    if not moved.goes_on:
        tried.go(_AIM if foretold is None else _NEAR_AIM)
    if tried.settled is not None:
        return Advice(tried.settled, tried.spent)
    if tried.is_hopeless:
        return Advice(None, tried.spent, tried.finest)
    if moved.failure:
        return Advice(None, tried.spent)
    if foretold is not None and not tried.errors:
        return Advice(foretold, tried.spent)
    stable = watch.stable_step()
    shortest = min(longest, stable or longest, tried.finest or longest)
    if watch.divided != 2:
        return Advice(min(longest, tried.finest or longest), tried.spent)
    return Advice(dividing_step(shortest, grid.interval), tried.spent)


class _Halvings:
    """A run taken again and again, each time with half the step of the time before."""

    def __init__(self, watch: MonitoredRun, begin: float) -> None:
        self._watch, self._begin = watch, begin
        self.errors: list[float] = []
        self.spent = 0
        self.settled: float | None = None
        self.finest: float | None = None

    def go(self, allowed: float) -> None:
        """Halve the step until half of it moves no figure by more than ``allowed``."""
        watch, count = self._watch, intervals_of(self._watch)
        before: RepeatedPart | None = None
        for halvings in range(_MOST_HALVINGS + 1):
            way = MethodAndStep(watch.grid.method, self._begin / 2**halvings)
            if not may_be_taken(watch, way, count):
                return
            again = taken_again(watch, watch.places[0], count, way)
            self.spent += again.steps
            if before is not None:
                finer = again.ranges.scales()
                self.errors.append(apart(watch, before, again, scales=finer)[0])
                if self.errors[-1] <= allowed:
                    self.settled = 2.0 * way.step
                    return
            before, self.finest, allowed = again, way.step, _AIM

    @property
    def is_hopeless(self) -> bool:
        """Whether halving the step has left the error about as large as it was."""
        found = self.errors[-_FEWEST - 1 :]
        if len(found) <= _FEWEST or not math.isfinite(found[0]):
            return False
        return found[-1] > found[0] * _SETTLING**_FEWEST
