"""Which cycle of the branches of a hunting study a simulated motion is."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.critical import CriticalPoint
from vehicledyn.analyse.periodic.cycle_points import Branch, CyclePoint
from vehicledyn.analyse.periodic.cycles_at import cycle_beside
from vehicledyn.analyse.settling.settling import Ending
from vehicledyn.analyse.settling.simulated_cycles import Settled
from vehicledyn.analyses.hunting.cycle_rows import CycleRows
from vehicledyn.base.errors import NumericalError

_SAME, _SAME_PERIOD = 0.05, 0.02
"""Relative differences of amplitude and period within which a motion is one of a branch."""

_ONE = 1e-3
"""Relative differences within which cycles of two branches are the same one."""

_BESIDE = 2e-3
"""Relative distance of values at which cycles count as neighbours, as beside a fold."""


@dataclass(frozen=True)
class Leg:
    """A piece of a branch between two points, or beside one, at a value of the parameter.

    The ranges of amplitude, of the middle of the first channel, and of the period [s] are those of
    its points; ``near`` is the nearer of them.
    """

    near: CyclePoint
    amplitudes: tuple[float, float]
    middles: tuple[float, float]
    periods: tuple[float, float]
    stable: bool

    def holds(self, found: Settled) -> bool:
        """Return whether a motion may be one of it, or the mirror image of one."""
        size = found.amplitude
        sizes, times = _SAME + found.spread, _SAME_PERIOD * found.period
        return (
            _within(size, self.amplitudes, sizes * size)
            and _within(found.period, self.periods, times)
            and any(_within(m, self.middles, sizes * size) for m in (found.middle, -found.middle))
        )


class Legs:
    """The branches of a study, searched by value of the parameter.

    Parameters
    ----------
    model
        The equations.
    rows
        Gives the range of the first channel.
    branches
        They may get more.
    """

    def __init__(self, model: AutonomousField, rows: CycleRows, branches: Sequence[Branch]) -> None:
        self._model, self._rows, self._branches = model, rows, branches
        self._exact: dict[tuple[int, float], CyclePoint | None] = {}

    def at(self, value: float) -> list[Leg]:
        """Return the pieces of all branches that pass a value."""
        return [
            self._leg(pair, value)
            for branch in self._branches
            for pair in pairwise(branch.points)
            if _within(value, _range([p.orbit.parameter for p in pair]), 0.0)
        ]

    def lack_stable(self, balances: Sequence[CriticalPoint]) -> bool:
        """Return whether oscillations grow somewhere and no stable cycle is found there."""
        return any(
            balance.growing_pairs and not any(leg.stable for leg in self.at(balance.value))
            for balance in balances
        )

    def of(self, found: Settled) -> Leg | None:
        """Return the piece that a motion is one of, a stable one if there is any."""
        fitting = [leg for leg in self.at(found.value) if leg.holds(found)]
        return next((leg for leg in fitting if leg.stable), fitting[0] if fitting else None)

    def is_known(self, found: Settled) -> bool:
        """Return whether a motion is one of a branch, or lies beside one of its points."""
        if self.of(found) is not None:
            return True
        beside = abs(_BESIDE * found.value)
        points = (p for branch in self._branches for p in branch.points)
        near = (p for p in points if abs(p.orbit.parameter - found.value) < beside)
        return any(self._leg((p,), found.value).holds(found) for p in near)

    def meets(self, point: CyclePoint, branches: Sequence[Branch]) -> int | None:
        """Return which of the first branches, from 0, a cycle of another one lies on, if on any."""
        row = self._rows.row(0, point)
        half = 0.5 * (float(row.greatest[0]) - float(row.smallest[0]))
        middle = 0.5 * (float(row.greatest[0]) + float(row.smallest[0]))
        for number, branch in enumerate(branches):
            for pair in pairwise(branch.points):
                if not _within(row.value, _range([p.orbit.parameter for p in pair]), 0.0):
                    continue
                leg = self._leg(pair, row.value)
                if (
                    _within(half, leg.amplitudes, _ONE * half)
                    and _within(row.period, leg.periods, _ONE * row.period)
                    and _within(abs(middle), _range(np.abs(leg.middles)), _ONE * half)
                ):
                    return number
        return None

    def exact(self, leg: Leg, value: float) -> CyclePoint | None:
        """Return the cycle of a piece at a value, if it is found."""
        key = id(leg.near), value
        if key not in self._exact:
            try:
                self._exact[key] = cycle_beside(self._model, leg.near, value)
            except NumericalError:
                self._exact[key] = None
        return self._exact[key]

    def difference(self, found: Settled) -> tuple[float, float] | None:
        """Return relative differences of amplitude and period to the cycle of a branch.

        None for a motion that has not settled, or on no stable piece.
        """
        leg = self.of(found) if found.ending is Ending.SETTLED else None
        cycle = self.exact(leg, found.value) if leg is not None and leg.stable else None
        if cycle is None or not cycle.stable:
            return None
        row = self._rows.row(0, cycle)
        size = abs(found.amplitude / float(row.amplitude[0]) - 1.0)
        return (size, abs(found.period / row.period - 1.0)) if size < _SAME else None

    def _leg(self, points: tuple[CyclePoint, ...], value: float) -> Leg:
        rows = [self._rows.row(0, point) for point in points]
        ends = np.array([[row.smallest[0], row.greatest[0]] for row in rows])
        return Leg(
            min(points, key=lambda p: abs(p.orbit.parameter - value)),
            _range(0.5 * (ends[:, 1] - ends[:, 0])),
            _range(0.5 * (ends[:, 1] + ends[:, 0])),
            _range([row.period for row in rows]),
            any(row.stable for row in rows),
        )


def _range(values: Sequence[float] | np.ndarray) -> tuple[float, float]:
    return float(min(values)), float(max(values))


def _within(value: float, ends: tuple[float, float], margin: float) -> bool:
    return ends[0] - margin <= value <= ends[1] + margin
