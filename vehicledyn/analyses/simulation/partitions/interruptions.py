"""What interrupts a run that is looked at: something must be done before it can go on."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from vehicledyn.analyses.simulation.partitions.singularity_crossing import Sample

if TYPE_CHECKING:
    from vehicledyn.multibody.loops.partition_monitor import PartitionComparison


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
        self, sample: Sample, comparison: PartitionComparison, before: Sample | None = None
    ) -> None:
        super().__init__()
        self.sample, self.comparison, self.before = sample, comparison, before


class Weakened(Exception):  # noqa: N818
    """Pivots of some blocks are useless at the end of a step, at a time [s]."""

    def __init__(self, blocks: Sequence[int], time: float) -> None:
        super().__init__()
        self.blocks, self.time = blocks, time


class Misled(Exception):  # noqa: N818
    """Steps have led elsewhere than the motion, which comes from ``before`` to ``right``."""

    def __init__(self, before: Sample, right: Sample) -> None:
        super().__init__()
        self.before, self.right = before, right
