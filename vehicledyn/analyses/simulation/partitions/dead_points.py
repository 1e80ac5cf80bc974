"""Changes of the partition between two looks at a run, before a coordinate turns at a dead point.

There the rates of dependent coordinates grow without bound, though the motion is smooth and other
coordinates describe it well. Rounding, or steps of a fixed size, may throw a loop onto its other
branch, which a look behind it does not show. So what happens between two looks is followed once
more, in steps of high order and controlled error, wherever a determinant may have come to zero.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.simulation.partitions.interruptions import (
    Crossing,
    Degrading,
    Misled,
)
from vehicledyn.analyses.simulation.partitions.partition_changes import (
    PartitionChanges,
    RestartPoint,
)
from vehicledyn.analyses.simulation.partitions.rederived import values_of
from vehicledyn.analyses.simulation.partitions.singularity_crossing import (
    FINE_TOLERANCE,
    TOLERANCE,
    Passage,
    Sample,
)
from vehicledyn.analyses.simulation.partitions.singularity_monitor import LEVERAGE
from vehicledyn.base.errors import NumericalError

if TYPE_CHECKING:
    from vehicledyn.multibody.loops.partition_monitor import PartitionComparison

Vector = NDArray[np.float64]

_AGREEMENT = 1e-4
"""Largest difference of states and unknowns, for one plus their size, of steps that are right."""
_LASTING = 0.5 * LEVERAGE
"""Leverage of a partition that is taken on the way to a place where the present one is useless."""
_WELL_REGULAR = 0.05
"""Least singular value of scaled constraints before a dead point, where they stay regular [1]."""


@dataclass
class DeadPoints:
    """Follows a run between its looks; ``replaced`` is the latest look that this has put right."""

    changes: PartitionChanges
    replaced: int = 0

    def __post_init__(self) -> None:
        """Follow as accurately as the method is, but no more coarsely than is safe."""
        adaptive = getattr(self.changes.plan.solver, "relative_tolerance", None)
        self._tolerance = min(TOLERANCE, max(adaptive or TOLERANCE, FINE_TOLERANCE))
        self._agreement = max(_AGREEMENT, 10.0 * (adaptive or 0.0))

    def change_for(self, degrading: Degrading) -> RestartPoint:
        """Change the partition at the first step at which another is clearly better.

        The steps since the look before are taken once more, as the last of them are inaccurate.
        """
        changes, sample, before = self.changes, degrading.sample, degrading.before
        earlier = changes.first_better(before, sample.time)
        if earlier is None:
            changes.refuse_late(sample, degrading.comparison)
        return self._change_at(before, *(earlier or (sample, degrading.comparison)))

    def change_at_step(self, crossing: Crossing) -> RestartPoint | None:
        """Change the partition at a step of fixed size before a crossing, if another is better."""
        earlier = self.changes.first_better(crossing.before, crossing.seen)
        if earlier is None:
            return None
        self.changes.log.release()
        return self._change_at(crossing.before, *earlier)

    def change_before(self, crossing: Crossing) -> RestartPoint | None:
        """Change the partition between looks, where nearer to the place another is better."""
        changes, plan, begin = self.changes, self.changes.plan, crossing.begin
        passage = self.passage_from(begin)
        for near in passage.approach(crossing.blocks, crossing.until):
            found = changes.better(near, LEVERAGE)
            if found is None or found.best_leverage > _LASTING:
                continue
            first, last = plan.index(begin.time) + 1, plan.index(near.time)
            samples = [passage.sample(plan.time(k)) for k in range(first, last)]
            kernel, here = changes.derive(near, found)
            rest = Passage(kernel, changes.pivots, here, self._tolerance)
            rest.advance(plan.time(last))
            end = rest.sample(plan.time(last))
            # Only now is this way certain: where it fails another one begins where it began.
            if samples:
                changes.log.restart(begin, samples)
            changes.adopt(kernel, here, found)
            changes.log.restart(here, [end])
            return RestartPoint(last, end.state, end.unknowns)
        return None

    def seems_regular(self, crossing: Crossing) -> bool:
        """Return whether the constraints seem to stay regular where a partition does not."""
        near = crossing.before or crossing.begin
        values = values_of(self.changes.kernel, near)
        return self.changes.watch.is_regular(near.time, values, _WELL_REGULAR)

    def motion_between(
        self, before: Sample, after: Sample, blocks: Sequence[int], least: Vector
    ) -> Sample | None:
        """Return where the motion leads from a look to the time of the next, which seems ``after``.

        Returns
        -------
        Sample or None
            The look itself where it is right, or an event lies in between; None where some of the
            pivots of ``blocks`` fall below their ``least`` sizes on the way.
        """
        if self._is_interrupted(before, after):
            return after
        passage = self.passage_from(before)
        try:
            if not passage.keeps_off(blocks, least, after.time):
                return None
            found = passage.sample(after.time)
        except NumericalError:
            return None
        finally:
            self.changes.parts.append(passage.statistics())
        return after if self._agree(found, after) else found

    def put_right(self, misled: Misled) -> RestartPoint:
        """Go on from where the motion leads, not from where the steps have led."""
        self.changes.log.restart(misled.before, [misled.right])
        self.replaced = self.changes.plan.index(misled.right.time)
        return RestartPoint(self.replaced, misled.right.state, misled.right.unknowns)

    def passage_from(self, sample: Sample) -> Passage:
        """Return a passage that begins at a sample."""
        return Passage(self.changes.kernel, self.changes.pivots, sample, self._tolerance)

    def _change_at(
        self, before: Sample | None, near: Sample, found: PartitionComparison
    ) -> RestartPoint:
        """Change the partition at a step behind a look, which is taken once more more accurately.

        If it turns out wrong, and nothing is to be changed there, the run goes on at the next look.
        """
        changes = self.changes
        if before is None or self._is_interrupted(before, near):
            return changes.change_between(near, found)
        passage = self.passage_from(before)
        passage.advance(near.time)
        right = passage.sample(near.time)
        if not self._agree(right, near):
            look = changes.plan.index(near.time)
            better = changes.better(right, 0.0)
            if better is None:
                passage.advance(changes.plan.time(look))
                return self.put_right(Misled(before, passage.sample(changes.plan.time(look))))
            near, found, self.replaced = right, better, look
        changes.parts.append(passage.statistics())
        return changes.change_between(near, found)

    def _is_interrupted(self, before: Sample, after: Sample) -> bool:
        """Return whether an event lies between two samples, over which nothing can be followed."""
        return any(before.time < t <= after.time for t in self.changes.event_times)

    def _agree(self, one: Sample, other: Sample) -> bool:
        pairs = (one.state, other.state), (one.unknowns, other.unknowns)
        apart = [np.abs(a - b) / (1.0 + np.abs(a)) for a, b in pairs]
        return max(float(part.max(initial=0.0)) for part in apart) < self._agreement
