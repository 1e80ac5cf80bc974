"""The pivots of the loops along a run: samples are held back where a loop is nearly singular."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.simulation.partitions.singularity_crossing import Sample
from vehicledyn.kernel.engine import WEAK_PIVOT

if TYPE_CHECKING:
    from vehicledyn.multibody.loops.partition_monitor import Comparison

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
_HARMLESS = 0.5
"""Product of all such parts below which the leverage is looked at: swapping two coordinates
multiplies the determinant by an entry of the leverage."""
_AGAIN = 0.8
_AHEAD = 1024
"""Samples whose pivots are looked at together."""
_MOST_HELD = 512
"""Samples that stay held back in a motion that is nearly singular for long."""


class Crossing(Exception):  # noqa: N818
    """A loop has become singular between two samples.

    ``begin`` is the last sample well before it, ``until`` a time behind it [s]. ``before`` is the
    last sample before it, and ``seen`` the time of the first behind [s].
    """

    def __init__(
        self,
        begin: Sample,
        blocks: Sequence[int],
        until: float,
        before: Sample | None = None,
        seen: float = 0.0,
    ) -> None:
        super().__init__()
        self.begin, self.blocks, self.until = begin, tuple(blocks), until
        self.before, self.seen = before, seen


class Degrading(Exception):  # noqa: N818
    """Other dependent coordinates would be clearly better at a sample.

    They may be so from ``before`` on, the sample before it, which is the last handed on then.
    """

    def __init__(
        self, sample: Sample, comparison: Comparison, before: Sample | None = None
    ) -> None:
        super().__init__()
        self.sample, self.comparison, self.before = sample, comparison, before


def are_harmless(values: Matrix, before: Vector, scale: Vector) -> Any:
    """Return at which samples no pivot is weak or changes its sign.

    ``values`` (n_samples, n_pivots) follow those ``before`` them, and the largest so far in
    ``scale``.
    """
    sizes = np.abs(values)
    largest = np.maximum(np.maximum.accumulate(sizes, axis=0), scale)
    earlier = np.vstack([before, values[:-1]])
    parts = sizes / np.where(largest > 0.0, largest, 1.0)
    harmless = (parts >= WEAK_PIVOT).all(axis=1) & (values * earlier > 0.0).all(axis=1)
    return harmless & (parts.prod(axis=1) >= _HARMLESS)


class PivotLog:
    """Takes the samples of a run, looks at their pivots and hands the good ones on."""

    def __init__(
        self,
        pivots: Callable[[Sequence[Sample]], Matrix],
        forward: Callable[[list[Sample]], None],
        better: Callable[[Sample, float], Comparison | None],
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
        zone
            Part of the largest determinant below which samples are held back.
        leverage
            Leverage that a partition is kept with.
        """
        self._pivots, self._hand_on, self._better = pivots, forward, better
        self._zone, self._leverage = zone, leverage
        self._anchor: Sample | None = None
        self._held: list[Sample] = []
        self._sound = 0
        self._is_due = False
        self._scale = np.zeros(0)
        self._before: Vector | None = None
        self._skip = False
        self._tried = np.inf

    def begin(self, *, skip: bool) -> None:
        """Expect samples of a new piece, of which the first is known if ``skip``."""
        self._skip = skip

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
        Crossing, Degrading
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
        k = 0
        try:
            while k < len(rows):
                count = self._count_harmless(values[k : k + _AHEAD])
                if count:
                    self._accept(rows[k : k + count], values[k : k + count])
                else:
                    self._look(rows[k], values[k])
                k += max(1, count)
        finally:
            self._release_due()

    def _count_harmless(self, values: Matrix) -> int:
        """Return how many samples pass before one whose pivots are weak or change sign."""
        if self._before is None:
            return 0
        harmless = are_harmless(values, self._before, self._scale)
        return len(values) if harmless.all() else int(np.argmin(harmless))

    def _accept(self, rows: list[Sample], values: Matrix) -> None:
        """Hand on samples whose pivots are far from zero, with all that came before."""
        self._held += rows
        self._before = values[-1]
        self._scale = np.maximum(self._scale, np.abs(values).max(axis=0))
        self._tried = np.inf
        self._is_due = True

    def _look(self, sample: Sample, values: Vector) -> None:
        """Look at one sample, and hold it back where a loop is nearly singular."""
        before = values if self._before is None else self._before
        scale = self._scale if self._scale.size else np.abs(values)
        near = np.abs(values) < _NEAR * scale
        crossed = np.flatnonzero((values * before < 0.0) | near)
        if crossed.size:
            self._release_due()
            self._cross(crossed, sample.time)
        self._scale = np.maximum(scale, np.abs(values))
        parts = np.abs(values) / self._scale
        share = float(np.min(parts, initial=1.0))
        if share < self._zone:
            self._release_due()
        self._held.append(sample)
        self._before = values
        self._try_others(sample, float(parts.prod()))
        if share >= ZONE:
            self._sound = len(self._held)
        if share >= self._zone:
            self._is_due = True
        elif len(self._held) > 2 * _MOST_HELD:
            self._release_first(_MOST_HELD)

    def _try_others(self, sample: Sample, share: float) -> None:
        if share >= _HARMLESS:
            self._tried = np.inf
        # A partition that gets weaker and weaker is looked at again at a part of the determinant.
        if share < min(_HARMLESS, _AGAIN * self._tried):
            comparison = self._better(sample, self._leverage)
            if comparison is not None:
                before = self._without_latest()
                raise Degrading(sample, comparison, before)
            self._tried = share

    def _without_latest(self) -> Sample | None:
        """Hand on all samples but the latest, and return the one before it."""
        latest = self._held.pop()
        if not self._held and self._anchor is None:
            self._held = [latest]
        self.release()
        return self._anchor if self._anchor is not latest else None

    def _cross(self, blocks: Iterable[Any], until: float) -> None:
        """Raise what follows from a pivot that has changed its sign before a time."""
        crossing = self._crossing(blocks, until)
        comparison = self._better(crossing.begin, 0.0)
        if comparison is not None:
            raise Degrading(crossing.begin, comparison)
        # Nearer to it another partition may be clearly better.
        if self._sound:
            sample = self._held[self._sound - 1]
            comparison = self._better(sample, 0.0)
            if comparison is not None:
                self._release_first(self._sound)
                raise Degrading(sample, comparison)
        raise crossing

    def _crossing(self, blocks: Iterable[Any], until: float) -> Crossing:
        begin = self._anchor or self._held[0]
        ahead = begin.time + 3.0 * (until - begin.time)
        return Crossing(begin, [int(k) for k in blocks], ahead, self.latest_or_none, until)

    def approaching(self, ahead: float) -> Crossing | None:
        """Return the crossing ahead if the last sample has a loop that is nearly singular."""
        if self._before is None or not self._before.size or self._anchor is None:
            return None
        share = np.abs(self._before) / self._scale
        near = np.flatnonzero(share < WEAK_PIVOT)
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
        self._before = self._pivots(samples[-1:])[0]

    def accept(self, sample: Sample) -> None:
        """Hand on a sample that has been taken back, unless all up to it have been handed on."""
        if sample is not self._anchor:
            self._held.append(sample)
            self.release()

    def change(self, sample: Sample) -> None:
        """Go on with another partition from a sample that has been handed on."""
        self._anchor, self._held, self._sound, self._tried = sample, [], 0, np.inf
        self._is_due = False
        self._before = self._pivots([sample])[0]
        self._scale = np.abs(self._before)
