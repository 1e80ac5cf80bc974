"""What a run does where a loop becomes singular: other coordinates before it, or a passage."""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.analyses.simulation.partitions.partition_changes import (
    PartitionChanges,
    RestartPoint,
)
from vehicledyn.analyses.simulation.partitions.singularity_crossing import (
    FINE_TOLERANCE,
    TOLERANCE,
    Passage,
    Sample,
)
from vehicledyn.analyses.simulation.partitions.singularity_monitor import LEVERAGE, Crossing
from vehicledyn.base.errors import NumericalError


@dataclass
class SingularityPassing:
    """Leads a run over singular configurations; ``passed`` is the look behind the latest one."""

    changes: PartitionChanges
    passed: int = 0

    def __post_init__(self) -> None:
        """Pass as accurately as the method is, but no more coarsely than is safe."""
        adaptive = getattr(self.changes.plan.solver, "relative_tolerance", None)
        self._tolerance = min(TOLERANCE, max(adaptive or TOLERANCE, FINE_TOLERANCE))

    def go(self, crossing: Crossing) -> RestartPoint:
        """Step over a singular configuration; return where the run goes on.

        Where other coordinates do better on the way to it, they are taken instead.
        """
        changes, plan = self.changes, self.changes.plan
        earlier = changes.first_better(crossing.before, crossing.seen)
        if earlier is not None:
            changes.log.release()
            return changes.change_between(*earlier)
        begin = crossing.begin
        passage = self._from(begin)
        try:
            behind = passage.go(crossing=crossing.blocks, until=crossing.until)
            first = plan.index(begin.time) + 1
            last = max(first, min(plan.index(behind), plan.n_looks))
            if plan.time(last) > behind:
                passage.advance(plan.time(last))
            samples = [passage.sample(plan.time(k)) for k in range(first, last + 1)]
            changes.parts.append(passage.statistics())
        except NumericalError as error:
            stuck = self._stuck(crossing, error)
            try:
                changed = self._change_before(crossing)
            except NumericalError:
                changed = None
            if changed is None:
                raise NumericalError(stuck) from None
            return changed
        changes.log.restart(begin, samples)
        self.passed = last
        return RestartPoint(last, samples[-1].state, samples[-1].unknowns)

    def _change_before(self, crossing: Crossing) -> RestartPoint | None:
        """Change the partition between samples, where nearer to the place another is better.

        That is so where a coordinate turns back at a dead point within few samples.
        """
        changes, plan, begin = self.changes, self.changes.plan, crossing.begin
        passage = self._from(begin)
        for near in passage.approach(crossing.blocks, crossing.until):
            found = changes.better(near, LEVERAGE)
            if found is None:
                continue
            first, last = plan.index(begin.time) + 1, plan.index(near.time)
            samples = [passage.sample(plan.time(k)) for k in range(first, last)]
            if samples:
                changes.log.restart(begin, samples)
            index, here = changes.changed(near, found)
            rest = self._from(here)
            rest.advance(plan.time(index))
            end = rest.sample(plan.time(index))
            changes.log.restart(here, [end])
            return RestartPoint(index, end.state, end.unknowns)
        return None

    def _stuck(self, crossing: Crossing, error: NumericalError) -> str:
        equations = self.changes.kernel.equations
        blocks = [equations.blocks[k] for k in crossing.blocks if k < len(equations.blocks)]
        names = equations.unknowns
        inside = [f"'{names[k].name}'" for b in blocks for k in range(b.start, b.stop)]
        loops = ", ".join(f"'{block.name}'" for block in blocks)
        what = f"the loop {loops} becomes" if blocks else "the rate constraints become"
        if len(blocks) < len(crossing.blocks):
            inside += [f"'{name}'" for name in equations.structure["rate_dependent"]]
        return (
            f"{what} singular soon after t = {crossing.begin.time:.9g} s and "
            f"no longer determines {', '.join(inside)}, nor would other coordinates do better; "
            f"the motion cannot be continued there ({error})"
        )

    def _from(self, sample: Sample) -> Passage:
        return Passage(self.changes.kernel, self.changes.pivots, sample, self._tolerance)
