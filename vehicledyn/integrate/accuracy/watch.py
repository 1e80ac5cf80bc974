"""The accuracy of a run with a fixed step: watched in short windows, judged at its end.

At samples spread over the run a few steps are taken again, with the step and with half of it.
What the two lead apart, added up over the whole run, bounds its error as long as motions do not
drive each other apart. A small bound ends the matter, for about a hundredth of the run's work.
Otherwise, or where energy comes from nowhere, the run is taken again with half the step, all of it
where that is cheap, else a part, and its key figures and its energy are compared. None of this
touches the run itself.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vehicledyn.integrate.accuracy.half_step_run import (
    MOVED,
    ends_without_reason,
    energy_is_off,
    look_again,
    look_at_start,
)
from vehicledyn.integrate.accuracy.recommended_step import recommended_step
from vehicledyn.integrate.accuracy.watched_run import DivergenceError, WatchedRun
from vehicledyn.integrate.accuracy.windows import (
    SPENT,
    STEPS,
    Grid,
    WindowStart,
    may_be_repeated,
    order_of,
    total_error,
)
from vehicledyn.integrate.estimated_accuracy import Accuracy
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.kernel import Kernel

_MOST_BOUND = {1: 0.01, 2: 0.04, 4: 0.04}
_MOST_IF_CHEAP = {1: 0.003, 2: 0.01, 4: 0.005}
"""What the errors in windows may add up to without a second look, by the order of the method; the
second where that costs little, as motions may amplify what goes wrong in a window tenfold.

Errors of order one have one sign throughout, and what amplifies them has all the run to do so.
"""

_STARTED, _FEWEST = 0.002, 3
"""Error in the first part of a run, or left at its end, from which on all of it is looked at, where
the first of so many windows is the only one to ask for that: what a start sets off fades.
"""

_GROWN, _ERRING = 1e3, 0.05
"""Growth of a range from the first half to the whole run, with errors, that marks divergence."""


@dataclass
class AccuracyWatch(WatchedRun):
    """Judges a run with a fixed step from what it has collected."""

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
        self.measure_kept()
        ends = self.latest[:-1] if ended_early else self.latest[-1:]
        places = [*self.places, *(p for p in ends if p.index > self.places[-1].index)]
        return self.judge(places, [self.window(p) for p in places], ended_early=ended_early)

    def judge(
        self, places: list[WindowStart], rows: list[Vector | None], *, ended_early: bool
    ) -> Accuracy:
        """Return the same from windows at some places, see :meth:`window`; None does not count."""
        found = [(p, row) for p, row in zip(places, rows, strict=True) if row is not None]
        n_channels = len(self.names)
        with np.errstate(all="ignore"):
            errors = np.array([row for _, row in found]).reshape(len(found), n_channels)
            errors = total_error(errors, self.grid.method) / self.ranges.scales()
        errors = np.nan_to_num(errors, nan=np.inf, posinf=np.inf)
        if ended_early and (not found or ends_without_reason(self)):
            found, errors = [(self.places[0], errors)], np.full((1, n_channels), np.inf)
        return self._judge([place for place, _ in found], errors, ended_early=ended_early)

    def _judge(self, places: list[WindowStart], errors: Vector, *, ended_early: bool) -> Accuracy:
        """Return what is to be said of the errors in windows, shape (n_windows, n_channels)."""
        spent = SPENT * len(places)
        bound, worst = bound_of(errors, self.taken * self.grid.per_interval)
        most = most_bound(self.kernel, self.grid)
        is_off = energy_is_off(self)
        if bound <= most and not is_off:
            name = f"'{self.names[worst]}'" if self.names else ""
            return Accuracy("accurate", bound, name, None, spent)
        if not (is_off or ended_early) and self._starts_only(places, errors, most):
            begun = look_at_start(self, places[0])
            spent += begun.extra_steps
            if begun.error <= _STARTED:
                return Accuracy("accurate", begun.error, begun.worst, None, spent)
        moved = look_again(self, places, errors, ended_early=ended_early)
        spent += moved.extra_steps
        if moved.error <= MOVED:
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
            "" if advice.step is not None else moved.failure,
        )

    def _starts_only(self, places: list[WindowStart], errors: Vector, most: float) -> bool:
        """Return whether no window but that at the start asks for a second look."""
        if len(places) < _FEWEST or places[0] is not self.places[0]:
            return False
        return bound_of(errors[1:], self.taken * self.grid.per_interval)[0] <= most

    def _diverged(self, errors: Vector) -> bool:
        """Return whether a channel grew out of all proportion, by errors of the last window."""
        with np.errstate(all="ignore"):
            growth = self.ranges.scales() / self.early.scales()
        return bool(((growth > _GROWN) & (errors[-1] > _ERRING)).any())


def most_bound(kernel: Kernel, grid: Grid) -> float:
    """Return what errors in windows may add up to without a second look, as a part of a range."""
    limits = _MOST_IF_CHEAP if may_be_repeated(kernel, grid) else _MOST_BOUND
    return limits[order_of(grid.method)]


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
