"""The accuracy of a run with a fixed step: watched in short windows, judged at its end.

At samples spread over the run a few steps are taken again, with the step and with half of it.
What the two lead apart, added up over the whole run, bounds its error as long as motions do not
drive each other apart. A small bound ends the matter, for about a hundredth of the run's work.
Otherwise, or where energy comes from nowhere, the run is taken again with half the step, all of it
where that is cheap, else a part, and its key figures and its energy are compared. None of this
touches the run itself.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vehicledyn.integrate.accuracy.divergence import DivergenceError
from vehicledyn.integrate.accuracy.half_step_run import (
    MOVED,
    ends_without_reason,
    energy_is_off,
    look_again,
    look_at_start,
    lost_energy,
)
from vehicledyn.integrate.accuracy.monitored_run import SEEN, MonitoredRun
from vehicledyn.integrate.accuracy.recommended_step import recommended_step
from vehicledyn.integrate.accuracy.windows import (
    HALF,
    SPENT,
    STEPS,
    UNEVEN,
    Pieces,
    StepGrid,
    WindowStart,
    closer_parts,
    may_be_repeated,
    order_of,
    total_error,
)
from vehicledyn.integrate.channel_ranges import Ranges
from vehicledyn.integrate.estimated_accuracy import ENERGY, Accuracy
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

_MUCH = 3.0
"""Times the error of windows with halves that uneven steps must find to count alone."""

_GROWN, _ERRING = 1e3, 0.05
"""Growth of a range from the first half to the whole run, with errors, that marks divergence."""


def finer_steps(number: int) -> Pieces:
    """Return the finer steps of a window by its number in the run: halves, then uneven ones."""
    return UNEVEN if number % 2 else HALF


@dataclass(frozen=True)
class Windows:
    """Errors in windows, in parts of ranges, shape (n_windows, n_channels).

    ``numbers`` are those of the windows in the run, which has ``n_steps``.
    """

    numbers: list[int]
    errors: Vector
    n_steps: int

    @classmethod
    def of(
        cls, rows: Sequence[Vector | None], grid: StepGrid, ranges: Ranges, n_samples: int
    ) -> Windows:
        """Return them from how far finer steps lead elsewhere, None where that does not count."""
        numbers = [k for k, row in enumerate(rows) if row is not None]
        scales = ranges.scales()
        with np.errstate(all="ignore"):
            found = np.array([rows[k] for k in numbers]).reshape(len(numbers), len(scales))
            errors = total_error(found, grid.method) / scales
        errors = np.nan_to_num(errors, nan=np.inf, posinf=np.inf)
        return cls(numbers, errors, n_samples * grid.per_interval)

    def bounds(self) -> Vector:
        """Return what they add up to in all steps, shape (n_channels,).

        Where uneven steps find much more than halves, theirs alone count.
        """
        if not self.errors.size:
            return np.zeros(self.errors.shape[1])
        parts = [self.errors[which] for which in (self._are_uneven, ~self._are_uneven)]
        uneven, halves = (np.mean(part, axis=0) if len(part) else np.inf for part in parts)
        usual = self.errors.mean(axis=0)
        found = np.where(np.isfinite(uneven) & (uneven > _MUCH * halves), uneven, usual)
        return np.asarray(found * max(1.0, self.n_steps / STEPS))

    def bound(self) -> tuple[float, int]:
        """Return what they add up to in the worst channel, and its number."""
        bounds = self.bounds()
        worst = int(np.argmax(bounds)) if bounds.size else 0
        return (float(bounds[worst]) if bounds.size else 0.0), worst

    def hidden(self, halves: Windows, most: float) -> tuple[int, int] | None:
        """Return row and channel of what uneven steps see and halves do not, None if nothing.

        ``halves`` are the errors that halves find in the windows with uneven steps; ``most`` is the
        bound that matters.
        """
        rows = [k for k, number in enumerate(self.numbers) if number in halves.numbers]
        if not rows or not halves.errors.size:
            return None
        found, seen = self.errors[rows].mean(axis=0), halves.errors.mean(axis=0)
        is_hidden = (seen < SEEN * found) & (found * max(1.0, self.n_steps / STEPS) > most)
        if not is_hidden.any():
            return None
        channel = int(np.argmax(np.where(is_hidden, found, 0.0)))
        return max(rows, key=lambda row: self.errors[row, channel]), channel

    def without_first(self) -> Windows:
        """Return all of them but the first."""
        return replace(self, numbers=self.numbers[1:], errors=self.errors[1:])

    @property
    def _are_uneven(self) -> NDArray[np.bool_]:
        return np.array([finer_steps(k) is UNEVEN for k in self.numbers], dtype=bool)


@dataclass
class AccuracyMonitor(MonitoredRun):
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
        rows = [self.window(p, finer_steps(k)) for k, p in enumerate(places)]

        def halves() -> list[Vector | None]:
            uneven = [row is not None and finer_steps(k) is UNEVEN for k, row in enumerate(rows)]
            return [
                self.window(place) if is_uneven else None
                for place, is_uneven in zip(places, uneven, strict=True)
            ]

        return self.judge(places, rows, halves, ended_early=ended_early)

    def judge(
        self,
        places: list[WindowStart],
        rows: list[Vector | None],
        halves: Callable[[], list[Vector | None]],
        *,
        ended_early: bool,
    ) -> Accuracy:
        """Return the same from windows at some places, see :meth:`window`; None does not count.

        The finer steps of each are those of :func:`finer_steps`; ``halves`` returns what halves
        would lead to in windows with uneven steps.
        """
        found = Windows.of(rows, self.grid, self.ranges, self.taken)
        if ended_early and (not found.numbers or ends_without_reason(self)):
            lost = np.full((1, len(self.names)), np.inf)
            found, places = replace(found, numbers=[0], errors=lost), self.places[:1]
        judged = self._judge(places, found, halves, ended_early=ended_early)
        closely = judged.verdict == "accurate" and not ended_early
        return self._looked_at_closely(judged) if closely else judged

    def _looked_at_closely(self, judged: Accuracy) -> Accuracy:
        """Return what is to be said of an accurate run after a look with much shorter steps.

        Forces that come and go within a step, or between two windows, show in nothing else. Only
        runs of a few milliseconds are looked at so.
        """
        parts = closer_parts(self.kernel, self.grid) if self.judged.closely and self.kept else None
        if parts is None:
            return judged
        self.divided = parts
        moved = look_again(self, [], np.zeros((0, 0)), ended_early=False)
        spent = judged.extra_steps + moved.extra_steps
        if moved.error <= MOVED or moved.failure:
            return replace(judged, extra_steps=spent)
        advice = recommended_step(self, moved)
        spent += advice.extra_steps
        return Accuracy("inaccurate", moved.error, moved.worst, advice.step, spent, advice.finest)

    def hidden(self, found: Windows, halves: list[Vector | None]) -> tuple[int, int] | None:
        """Return what halves do not see, see :meth:`Windows.hidden`."""
        seen = Windows.of(halves, self.grid, self.ranges, self.taken)
        return found.hidden(seen, most_bound(self.kernel, self.grid))

    def _judge(
        self,
        places: list[WindowStart],
        found: Windows,
        halves: Callable[[], list[Vector | None]],
        *,
        ended_early: bool,
    ) -> Accuracy:
        """Return what is to be said of the errors in windows."""
        spent, errors = SPENT * len(found.numbers), found.errors
        bound, worst = found.bound()
        most = most_bound(self.kernel, self.grid)
        is_off = energy_is_off(self)
        if bound <= most and not is_off:
            lost, name = lost_energy(self), f"'{self.names[worst]}'" if self.names else ""
            if lost > 0.0:
                return Accuracy("inaccurate", lost, f"'{ENERGY}'", None, spent)
            return Accuracy("accurate", bound, name, None, spent)
        kept = [places[k] for k in found.numbers]
        hidden = None if ended_early else self.hidden(found, halves())
        if hidden is not None:
            self.divide_to_see(kept[hidden[0]], hidden[1])
        if not (is_off or ended_early) and self._starts_only(kept, found, most):
            begun = look_at_start(self, kept[0])
            spent += begun.extra_steps
            if begun.error <= _STARTED:
                return Accuracy("accurate", begun.error, begun.worst, None, spent)
        moved = look_again(self, kept, errors, ended_early=ended_early)
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

    def _starts_only(self, places: list[WindowStart], found: Windows, most: float) -> bool:
        """Return whether no window but that at the start asks for a second look."""
        if len(places) < _FEWEST or places[0] is not self.places[0]:
            return False
        return found.without_first().bound()[0] <= most

    def _diverged(self, errors: Vector) -> bool:
        """Return whether a channel grew out of all proportion, by errors of the last window."""
        with np.errstate(all="ignore"):
            growth = self.ranges.scales() / self.early.scales()
        return bool(((growth > _GROWN) & (errors[-1] > _ERRING)).any())


def most_bound(kernel: Kernel, grid: StepGrid) -> float:
    """Return what errors in windows may add up to without a second look, as a part of a range."""
    limits = _MOST_IF_CHEAP if may_be_repeated(kernel, grid) else _MOST_BOUND
    return limits[order_of(grid.method)]
