"""A branch of cycles outside the range that is asked for: how far it is followed, and words for it.

A branch that leaves a range may fold and come back, with cycles that another way does not reach.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from vehicledyn.analyse.periodic.cycle_points import Branch, CyclePoint, Limits

_FEWEST, _PART = 6, 2
"""Points outside at least, and part of those allowed inside."""

_FARTHEST, _FARTHEST_VALUE = 0.5, 0.3
"""How far outside a branch is followed: part of the range and of the way to zero below it, and of
the largest value. It does not depend on a narrow range."""


def outer_range(low: float, high: float) -> tuple[float, float]:
    """Return how far a branch that leaves a range is followed."""
    way = max(_FARTHEST * (high - low), _FARTHEST_VALUE * max(abs(low), abs(high)))
    below = min(way, _FARTHEST * low) if low > 0.0 else way
    return low - below, high + way


@dataclass
class RangeExcursion:
    """Where a branch left the range and came back, while it is followed.

    ``edges`` are the ends of the range in the order it passed them, ``count`` the number of its
    points outside; ``is_cut`` says that it has as many as it may have.
    """

    edges: list[float] = field(default_factory=list)
    count: int = 0
    is_cut: bool = False

    def pass_edge(self, edge: float) -> None:
        """Note that the branch passes an end of the range."""
        self.edges.append(edge)

    def ends_before(self, point: CyclePoint, limits: Limits) -> bool:
        """Return whether the branch ends before a point outside: too far, or one too many."""
        self.is_cut = self.count >= max(_FEWEST, limits.points // _PART)
        return self.is_cut or not limits.reaches(point.orbit.parameter)

    def remark(
        self, parameter: str, tail: Sequence[CyclePoint], branch: Branch, limits: Limits
    ) -> str:
        """Return where the branch left the range, and whether it came back; empty if it did not.

        Parameters
        ----------
        parameter
            Name of the parameter.
        tail
            The points that do not lead back into the range.
        branch
            The branch without them.
        limits
            The range.
        """
        ways = [
            f"it leaves the range at {parameter} = {out:.6g} and comes back into it at {back:.6g}"
            for out, back in zip(self.edges[::2], self.edges[1::2], strict=False)
        ]
        if len(self.edges) % 2:
            ways.append(self._left(parameter, tail, branch))
        below = [
            p.orbit.parameter for p in branch.points if p.stable and p.orbit.parameter < limits.low
        ]
        if below:
            ways.append(f"below the range it is stable down to {min(below):.6g}")
        return "; ".join(ways)

    def _left(self, parameter: str, tail: Sequence[CyclePoint], branch: Branch) -> str:
        """Return words for a branch that ends outside."""
        edge = self.edges[-1]
        start = f"it leaves the range at {parameter} = {edge:.6g}"
        if not tail:
            return start
        values = [p.orbit.parameter for p in tail]
        farthest = max(values, key=lambda v: abs(v - edge))
        why = f" after {self.count} cycles outside" if self.is_cut else ""
        how = {
            "lost": f"is lost outside, near {values[-1]:.6g}",
            "equilibrium": f"ends outside, in an equilibrium at {values[-1]:.6g}",
        }.get(branch.ending, f"has not come back up to {farthest:.6g}, where it is left{why}")
        stable = [p.orbit.parameter for p in tail if p.stable]
        lowest = f"; stable cycles outside reach down to {min(stable):.6g}" if stable else ""
        return f"{start} and {how}{lowest if stable and min(stable) < edge else ''}"
