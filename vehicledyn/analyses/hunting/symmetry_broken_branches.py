"""Branches of cycles that branch off mirror-symmetric ones, at branch points."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Protocol

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.collocation import Direction
from vehicledyn.analyse.periodic.cycle_points import Branch, CyclePoint
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.analyse.periodic.symmetry_breaking import LeadingOff, OwnImages, leading_off
from vehicledyn.base.errors import NumericalError

_MOST_BRANCHES, _FEWEST_CYCLES = 3, 4
"""Branches that are followed at most, and cycles left with which one is begun."""

_WIDE = 2.0
"""How much wider their steps are."""

_OFF = 0.03, 0.01, 0.1
"""Ways off a branch point, part of the scales, at which the first cycle is looked for."""

_SAME_POINT = 1e-2
"""Relative differences of range and period within which a branch reaches a branch point, where its
last steps were smaller."""


class Follow(Protocol):
    """Follows a branch as a study does, and adds it to those that it has."""

    def __call__(
        self,
        start: Orbit,
        direction: Direction,
        place: str,
        *,
        most: int,
        wide: float,
        known: Sequence[Branch],
        joins: Callable[[Branch], int | None],
    ) -> Branch:
        """Return it."""


@dataclass
class Secondary:
    """Branches that branch off the first ones of a study.

    ``branches`` and ``messages`` are those of the study, ``span`` its range; ``origins`` say by
    number where branches begin.
    """

    model: AutonomousField
    span: tuple[float, float]
    branches: list[Branch]
    messages: list[str]
    origins: dict[int, str]
    follow: Follow
    _points: list[tuple[int, CyclePoint]] = field(init=False)
    _reached: list[CyclePoint] = field(default_factory=list, init=False)

    def __post_init__(self) -> None:
        """Note the branch points with the numbers of their branches."""
        self._points = [
            (number, point)
            for number, branch in enumerate(self.branches, 1)
            for point in branch.special
            if point.kind == "branch_point"
        ]

    def examine(self, cycles: int) -> None:
        """Follow the branches off all branch points, of so many cycles together at most.

        One that ends at a further branch point is not followed again from there.
        """
        first = len(self.branches)
        for number, point in self._points:
            if any(point is other for other in self._reached):
                continue
            place = f"{self.model.parameter} = {point.orbit.parameter:.6g}"
            left = cycles - sum(len(branch.points) for branch in self.branches[first:])
            if len(self.branches) - first == _MOST_BRANCHES or left < _FEWEST_CYCLES:
                self.messages.append(
                    f"what branches off branch {number} at {place}, and what follows, is left out: "
                    f"branches off branch points are {_MOST_BRANCHES} at most, with {cycles} "
                    "cycles together"
                )
                return
            try:
                way = leading_off(self.model, point, self.span)
                if way is None:
                    self.messages.append(
                        f"what branches off branch {number} at {place} is not followed: there is "
                        "no multiplier -1 of half a mirror-symmetric cycle"
                    )
                else:
                    self._lead_off(way, number, first=first, most=left)
            except NumericalError as error:
                self.messages.append(
                    f"what branches off branch {number} at {place} is not found: {error}"
                )

    def _lead_off(self, way: LeadingOff, number: int, *, first: int, most: int) -> None:
        """Follow the branch off a branch point."""
        own, n_messages = len(self.branches) + 1, len(self.messages)
        known = [Branch() if k < first else b for k, b in enumerate(self.branches)]
        for size in _OFF:
            self.origins[own] = (
                f"branches off branch {number} at {self.model.parameter} = "
                f"{way.orbit.parameter:.6g}; its mirror image counts as the same branch"
            )
            try:
                self.follow(
                    way.start(size),
                    way.along,
                    f"off branch {number}",
                    most=most,
                    wide=_WIDE,
                    known=known,
                    joins=partial(self._joined, OwnImages(way)),
                )
            except NumericalError:
                if size == _OFF[-1]:
                    raise
            else:
                return
            finally:
                self.branches[:] = [branch for branch in self.branches if branch.points]
                if len(self.branches) < own:
                    del self.origins[own]
                else:
                    self.messages.insert(n_messages, f"branch {own} {self.origins[own]}")

    def _joined(self, images: OwnImages, branch: Branch) -> int | None:
        """Return which branch another one has come back to, and note the branch point there."""
        if not images.are_met(branch.points):
            return None
        value, period, step = images.place(branch.points)
        span = self.span[1] - self.span[0]

        def apart(found: tuple[int, CyclePoint]) -> float:
            orbit = found[1].orbit
            return max(abs(orbit.parameter - value) / span, abs(orbit.period / period - 1.0))

        number, point = min(self._points, key=apart)
        if apart((number, point)) < max(step / span, _SAME_POINT):
            self._reached.append(point)
        return number
