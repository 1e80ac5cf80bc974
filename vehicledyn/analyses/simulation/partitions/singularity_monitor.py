"""The pivots of the loops along a run: samples are held back where a loop is nearly singular."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.simulation.partitions.expected_pivots import (
    HARMLESS,
    LastLook,
    are_harmless,
    unlikely,
)
from vehicledyn.analyses.simulation.partitions.interruptions import (
    Crossing,
    Degrading,
    Misled,
    Weakened,
)
from vehicledyn.analyses.simulation.partitions.singularity_crossing import Sample
from vehicledyn.kernel.engine import WEAK_PIVOT

if TYPE_CHECKING:
    from vehicledyn.multibody.loops.partition_monitor import PartitionComparison

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

ZONE, WIDE_ZONE = 0.1, 0.3
"""Determinant, as a part of the largest met, below which samples are held back.

The wide one is for adaptive steps of high order: samples before a singular configuration come
from the dense output of a step that may reach over it, whose stages are lost in rounding.
"""
_NEAR = 0.01
"""The same part below which a sample is too near to a singular configuration to be trusted."""
LEVERAGE, FINE_LEVERAGE = 10.0, 3.0
"""Largest dependent rate of a unit independent rate that a partition is kept with; the second with
steps of a fixed size, whose errors grow with a power of it, at regular constraints."""
_SHORTER = 0.7
"""Part of the longest step since the last that was looked at below which one is looked at."""
_AGAIN = 0.8
"""Ratio of the levels of the determinants, from HARMLESS down, at which others are looked at: the
same with all steps, so that changes of partitions converge as steps get shorter."""
_LEAST = 1e-300
_AHEAD = 1024
"""Samples whose pivots are looked at together."""
_MOST_HELD = 512
"""Samples that stay held back in a motion that is nearly singular for long."""


class PivotLog:
    """Takes the samples of a run, looks at their pivots and hands the good ones on."""

    def __init__(
        self,
        pivots: Callable[[Sequence[Sample]], Matrix],
        forward: Callable[[list[Sample]], None],
        better: Callable[[Sample, float], PartitionComparison | None],
        rates: Callable[[Sample], Vector],
        motion: Callable[[Sample, Sample, Sequence[int], Vector], Sample | None],
        *,
        zone: float = ZONE,
        leverage: float = LEVERAGE,
    ) -> None:
        """Start with no samples.

        Parameters
        ----------
        pivots
            Gives the determinants of the loops, and those of the rates alone, at some samples,
            one row a sample.
        forward
            Takes the good samples.
        better
            Gives the comparison with a better partition at a sample, if the leverage of the
            present one is above a limit and there is one.
        rates
            Gives the rates of the pivots at a sample [1/s].
        motion
            Gives where the motion leads from a sample to the time of another; that one itself where
            it is right, None where some pivots fall below least sizes on the way.
        zone
            Part of the largest determinant below which samples are held back.
        leverage
            Leverage that a partition is kept with.
        """
        self._pivots, self._hand_on, self._better = pivots, forward, better
        self._rates, self._motion = rates, motion
        self._zone, self._leverage = zone, leverage
        self._anchor: Sample | None = None
        self._held: list[Sample] = []
        self._sound = 0
        self._is_due = False
        self._last: LastLook | None = None
        self._longest = 0.0
        self._skip = False
        self._tried = np.inf

    def begin(self, *, skip: bool) -> None:
        """Expect samples of a new piece, of which the first is known if ``skip``."""
        self._skip = skip

    def known_at(self, time: float) -> tuple[Sample, Vector] | None:
        """Return the last sample and what is known there, for a run that goes on from it.

        None is returned if that is not the one at a time [s], or where samples are held back.
        """
        anchor, last = self._anchor, self._last
        if self._held or anchor is None or last is None:
            return None
        if anchor.time != time or last.time != time:
            return None
        own = np.array([self._longest, self._tried])
        return anchor, np.concatenate([own, last.pivots, last.rates, last.scale])

    def recall(self, anchor: Sample, known: Vector) -> None:
        """Go on from what was known at a sample that has been handed on."""
        self._longest, self._tried = map(float, known[:2])
        self._anchor, self._last = anchor, LastLook(anchor.time, *np.split(known[2:], 3))

    @property
    def latest_or_none(self) -> Sample | None:
        """The last sample, if there is one."""
        return self._held[-1] if self._held else self._anchor

    @property
    def latest(self) -> Sample:
        """The last sample."""
        found = self.latest_or_none
        if found is None:
            raise ValueError("no sample has been taken yet")
        return found

    @property
    def latest_time(self) -> float | None:
        """Time of the last sample [s]."""
        found = self.latest_or_none
        return None if found is None else found.time

    def take(self, times: Vector, states: Vector, unknowns: Vector, outputs: Vector) -> None:
        """Take samples; a sink.

        Raises
        ------
        Crossing, Degrading, Misled
            If something must be done before the run can go on; the samples up to there are
            handed on, later ones are forgotten.
        """
        rows = [
            Sample(float(t), x, z, y)
            for t, x, z, y in zip(times, states, unknowns, outputs, strict=True)
        ]
        if self._skip and rows:
            rows, self._skip = rows[1:], False
        values = self._pivots(rows) if rows else np.zeros((0, 0))
        k, times = 0, times[len(times) - len(rows) :]
        try:
            while k < len(rows):
                part = slice(k, k + _AHEAD)
                count = self._count_harmless(times[part], values[part])
                if count and self._last is not None:
                    part = slice(k, k + count)
                    self._accept(rows[part])
                    self._last = self._last.then(times[part], values[part])
                else:
                    self._look(rows[k], values[k])
                k += max(1, count)
        finally:
            self._release_due()

    def wants_step(self, size: float) -> bool:
        """Return whether to look at the end of a step of some size [s] that the method has chosen.

        Such steps become shorter and shorter towards a dead point, where rounding makes them lead
        anywhere at last. So those are looked at that are shorter than others before.
        """
        self._longest = max(self._longest, size)
        if size > _SHORTER * self._longest:
            return False
        self._longest = size
        return True

    def at_step(self, sample: Sample) -> None:
        """Look at the end of a step.

        Raises
        ------
        Weakened
            If a pivot has changed its sign there, or is too near to zero to be trusted.
        """
        if self._last is None:
            return
        values = self._pivots([sample])[0]
        near = np.abs(values) < _NEAR * self._last.scale
        found = np.flatnonzero((values * self._last.pivots < 0.0) | near).tolist()
        if found:
            raise Weakened(found, sample.time)

    def _count_harmless(self, times: Vector, values: Matrix) -> int:
        """Return how many samples pass before one whose pivots are weak or change sign."""
        if self._last is None:
            return 0
        harmless = are_harmless(times, values, self._last)
        return len(values) if harmless.all() else int(np.argmin(harmless))

    def _doubtful(self, sample: Sample, values: Vector, last: LastLook) -> list[int]:
        """Return the pivots that may have been zero since the last sample and were not seen so."""
        before = self.latest
        found = unlikely(
            sample.time, values, last, lambda: (self._rates(before), self._rates(sample))
        )
        if not found:
            return []
        largest = np.maximum(last.scale, np.abs(values))
        right = self._motion(before, sample, found, _NEAR * largest[found])
        if right is None:
            return found
        if right is not sample:
            self.release()
            raise Misled(before, right)
        return []

    def _accept(self, rows: list[Sample]) -> None:
        """Hand on samples whose pivots are far from zero, with all that came before."""
        self._held += rows
        self._tried = np.inf
        self._is_due = True

    def _look(self, sample: Sample, values: Vector) -> None:
        """Look at one sample, and hold it back where a loop is nearly singular."""
        last = self._last or self._looked_at(sample, values)
        near = np.abs(values) < _NEAR * last.scale
        crossed = np.flatnonzero((values * last.pivots < 0.0) | near).tolist()
        if not crossed and self._last is not None:
            crossed = self._doubtful(sample, values, last)
        if crossed:
            self._release_due()
            raise self.met(crossed, sample.time)
        if self._last is not None:
            last = last.then(np.array([sample.time]), values[None])
        self._last = last
        parts = np.abs(values) / last.scale
        share = float(np.min(parts, initial=1.0))
        if share < self._zone:
            self._release_due()
        self._held.append(sample)
        self._try_others(sample, float(parts.prod()))
        if share >= ZONE:
            self._sound = len(self._held)
        if share >= self._zone:
            self._is_due = True
        elif len(self._held) > 2 * _MOST_HELD:
            self._release_first(_MOST_HELD)

    def _try_others(self, sample: Sample, share: float) -> None:
        if share >= HARMLESS:
            self._tried = np.inf
        # A partition that gets weaker and weaker is looked at again at the next level.
        if share < _level_below(self._tried):
            comparison = self._better(sample, self._leverage)
            if comparison is not None:
                before = self._without_latest()
                raise Degrading(sample, comparison, before)
            self._tried = share

    def at_levels(self, samples: Sequence[Sample]) -> list[Sample]:
        """Return those at which the determinants come below a level, behind the last look."""
        if self._last is None or not samples:
            return list(samples)
        shares = (np.abs(self._pivots(samples)) / self._last.scale).prod(axis=1)
        found, tried = [], self._tried
        for sample, share in zip(samples, shares, strict=True):
            if share < _level_below(tried):
                found.append(sample)
                tried = float(share)
        return found

    def _without_latest(self) -> Sample | None:
        """Hand on all samples but the latest, and return the one before it."""
        latest = self._held.pop()
        if not self._held and self._anchor is None:
            self._held = [latest]
        self.release()
        return self._anchor if self._anchor is not latest else None

    def met(self, blocks: Sequence[int], until: float) -> Crossing | Degrading:
        """Return what follows from pivots that have come to zero before a time."""
        crossing = self._crossing(blocks, until)
        comparison = self._better(crossing.begin, 0.0)
        if comparison is not None:
            return Degrading(crossing.begin, comparison)
        # Nearer to it another partition may be clearly better.
        if self._sound:
            sample = self._held[self._sound - 1]
            comparison = self._better(sample, 0.0)
            if comparison is not None:
                self._release_first(self._sound)
                return Degrading(sample, comparison)
        return crossing

    def _crossing(self, blocks: Iterable[Any], until: float) -> Crossing:
        begin = self._anchor or self._held[0]
        ahead = begin.time + 3.0 * (until - begin.time)
        return Crossing(begin, [int(k) for k in blocks], ahead, self.latest_or_none, until)

    def approaching(self, ahead: float) -> Crossing | None:
        """Return the crossing ahead if a loop is nearly singular, or may be in a time [s]."""
        last = self._last
        if last is None or not last.pivots.size or self._anchor is None:
            return None
        expected = (last.pivots + ahead * last.rates) * np.sign(last.pivots)
        near = np.flatnonzero(
            (np.abs(last.pivots) < WEAK_PIVOT * last.scale) | (expected < _NEAR * last.scale)
        )
        return self._crossing(near, self.latest.time + ahead) if near.size else None

    def back_to_sound(self) -> Sample | None:
        """Forget the samples that are held back; return the last that has been handed on."""
        self._held, self._sound = [], 0
        return self._anchor

    def _release_due(self) -> None:
        """Hand on the samples that nothing holds back: many at once cost less than one by one."""
        if self._is_due:
            self.release()

    def release(self) -> None:
        """Hand on all samples."""
        held, self._held, self._sound, self._is_due = self._held, [], 0, False
        if held:
            self._anchor = held[-1]
            self._hand_on(held)

    def _release_first(self, count: int) -> None:
        """Hand on the first of the samples that are held."""
        kept, sound = self._held[count:], max(0, self._sound - count)
        del self._held[count:]
        self.release()
        self._held, self._sound = kept, sound

    def release_to(self, sample: Sample) -> Sample:
        """Hand on all samples and return the last."""
        self.release()
        return sample

    def restart(self, begin: Sample, samples: list[Sample]) -> None:
        """Forget what came behind a sample; hand on those that replace it."""
        self._held = samples
        self.release()
        now = self._looked_at(samples[-1], self._pivots(samples[-1:])[0])
        self._last = now if self._last is None else now._replace(scale=self._last.scale)

    def accept(self, sample: Sample) -> None:
        """Hand on a sample that has been taken back, unless all up to it have been handed on."""
        if sample is not self._anchor:
            self._held.append(sample)
            self.release()

    def change(self, sample: Sample) -> None:
        """Go on with another partition from a sample that has been handed on."""
        self._anchor, self._held, self._sound, self._tried = sample, [], 0, np.inf
        self._is_due = False
        self._last = self._looked_at(sample, self._pivots([sample])[0])

    def _looked_at(self, sample: Sample, values: Vector) -> LastLook:
        """Return the look at a sample, of which nothing was known before."""
        return LastLook(sample.time, values, self._rates(sample), np.abs(values))


def _level_below(share: float) -> float:
    """Return the next level below a product of parts of determinants."""
    if share >= HARMLESS:
        return HARMLESS
    passed = math.floor(math.log(max(share, _LEAST) / HARMLESS) / math.log(_AGAIN))
    return float(HARMLESS * _AGAIN ** (passed + 1))
