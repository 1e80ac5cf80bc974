"""Branches of cycles that begin where simulations settled to a cycle of none that is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.cycle_points import Branch
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.analyse.settling.settling import Ending
from vehicledyn.analyse.settling.simulated_cycles import Settled
from vehicledyn.analyses.hunting.branch_matching import Legs
from vehicledyn.analyses.hunting.start import DEGREE
from vehicledyn.base.errors import NumericalError

_MOST_BRANCHES, _FEWEST_CYCLES = 3, 4
"""Branches that are begun at most, and cycles left with which another one is."""

_WIDE = 2.0
"""How much wider their steps are."""

_NEARLY = 5e-3
"""Largest spread of a motion that nearly repeats."""


class Follow(Protocol):
    """Follows a branch as a study does, and adds it to those that it has."""

    def __call__(
        self,
        start: Orbit,
        direction: None,
        place: str,
        *,
        upwards: bool = True,
        most: int,
        wide: float,
        known: Sequence[Branch],
    ) -> Branch:
        """Return it."""


@dataclass
class FromSimulations:
    """Branches that a study follows from simulated cycles.

    ``branches`` and ``messages`` are those of the study, ``last`` the end of its range and
    ``intervals`` those of its first cycles.
    """

    model: AutonomousField
    last: float
    intervals: int
    branches: list[Branch]
    messages: list[str]
    legs: Legs
    follow: Follow

    def examine(self, simulated: Sequence[Settled], cycles: int) -> None:
        """Follow branches from cycles that lie on none, to both sides, those that settled first.

        Together they have at most so many cycles.
        """
        joined, begun, left = len(self.branches), 0, cycles
        for found in sorted(simulated, key=lambda settled: settled.spread):
            repeats = found.ending is not Ending.CUT and found.spread < _NEARLY
            if begun == _MOST_BRANCHES or left < _FEWEST_CYCLES or not repeats:
                break
            if self.legs.is_known(found):
                continue
            begun += 1
            try:
                left -= self._from(found, left)
            except NumericalError as error:
                self.messages.append(
                    f"the motion simulated at {self.model.parameter} = {found.value:.6g} lies on "
                    f"no branch, and no branch can be followed from it: {error}"
                )
            finally:
                self.branches[:] = [branch for branch in self.branches if branch.points]
        further = self.branches[joined:]
        if joined and further and all(branch.ending != "joined" for branch in further):
            self.messages.append(
                f"branches from {joined + 1} on are followed from simulated cycles; in this range "
                "they are not found to be joined to those before"
            )

    def _from(self, found: Settled, most: int) -> int:
        """Follow the cycle that a simulation settled to, to both sides; return how many there are.

        Each side gets half of the cycles that there may be at most, or what the other leaves.
        """
        above = found.value < self.last
        start = found.orbit(self.model, intervals=self.intervals, degree=DEGREE)
        half, known = most // 2 if above else most, list(self.branches)
        down = self.follow(
            start,
            None,
            "down from the simulated one",
            upwards=False,
            most=half,
            wide=_WIDE,
            known=known,
        )
        if above and down.points:
            first, half = down.points[0].orbit, most - len(down.points)
            up = self.follow(
                first, None, "up from the simulated one", most=half, wide=_WIDE, known=known
            )
            self.branches[:] = [branch for branch in self.branches if branch is not up]
            down.ending = "joined" if up.ending == "joined" else down.ending
            down.points[:0] = up.points[:0:-1]
        return len(down.points)
