"""What a run does where a loop becomes singular: other coordinates before it, or a passage."""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.analyses.simulation.partitions.dead_points import DeadPoints
from vehicledyn.analyses.simulation.partitions.interruptions import Crossing
from vehicledyn.analyses.simulation.partitions.partition_changes import (
    PartitionChanges,
    RestartPoint,
)
from vehicledyn.base.errors import NumericalError


@dataclass
class SingularityPassing:
    """Leads a run over singular configurations; ``passed`` is the look behind the latest one."""

    changes: PartitionChanges
    dead_points: DeadPoints
    passed: int = 0

    def go(self, crossing: Crossing) -> RestartPoint:
        """Step over a singular configuration; return where the run goes on.

        Where other coordinates do better on the way to it, they are taken instead.
        """
        changed = self.dead_points.change_at_step(crossing)
        if changed is not None:
            return changed
        ways = [self._pass, self.dead_points.change_before]
        if self.dead_points.seems_regular(crossing):
            ways.reverse()
        reasons = []
        for way in ways:
            try:
                place = way(crossing)
            except NumericalError as error:
                reasons.append(str(error))
            else:
                if place is not None:
                    return place
        raise NumericalError(self._stuck(crossing, "; ".join(reasons)))

    def _pass(self, crossing: Crossing) -> RestartPoint:
        """Step over the place itself."""
        plan, parts, begin = self.changes.plan, self.changes.parts, crossing.begin
        passage = self.dead_points.passage_from(begin)
        try:
            behind = passage.go(crossing=crossing.blocks, until=crossing.until)
            first = plan.index(begin.time) + 1
            last = max(first, min(plan.index(behind), plan.n_looks))
            if plan.time(last) > behind:
                passage.advance(plan.time(last))
            samples = [passage.sample(plan.time(k)) for k in range(first, last + 1)]
        finally:
            parts.append(passage.statistics())
        self.changes.log.restart(begin, samples)
        self.passed = last
        return RestartPoint(last, samples[-1].state, samples[-1].unknowns)

    def _stuck(self, crossing: Crossing, reasons: str) -> str:
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
            f"the motion cannot be continued there ({reasons})"
        )
