"""A system made ready to be driven along a path: what moves, and what stays at its start."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import qr

from vehicledyn.analyse.continuation import (
    BranchEquations,
)
from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.multibody.loops.position_level import Positions

Array = NDArray[np.float64]
_RANK = 1e-9
_NAMED = 0.9
"""Coordinates that move at least this part of what the freest one does are named."""


@dataclass(frozen=True)
class Mechanism:
    """A system with the coordinates that move and the channels that are driven.

    ``moving`` are indices of coordinates that loops and drives determine together, ``held``
    names of coordinates that would be free and stay at their start.
    """

    positions: Positions
    drives: tuple[int, ...]
    moving: tuple[int, ...]
    held: tuple[str, ...]

    @property
    def gaps(self) -> int:
        """Number of rows of the loops; those of the drives come after them."""
        return len(self.positions.cuts)

    @property
    def equations(self) -> BranchEquations:
        """Gaps and driven channels as functions of the moving coordinates."""
        p, drives, moving = self.positions, list(self.drives), list(self.moving)

        def rows(u: Array) -> Array:
            q = self.full(u)
            return np.concatenate([p.residual(q), p.values(q)[drives]])

        def jacobian(u: Array) -> Array:
            q = self.full(u)
            return np.vstack([p.jacobian(q), p.slopes(q)[drives]])[:, moving]

        return BranchEquations(rows, jacobian)

    def full(self, u: Array) -> Array:
        """Return all coordinates, those that do not move at their start."""
        q = self.positions.start.copy()
        q[list(self.moving)] = u
        return q

    def targets(self, values: Sequence[float]) -> Array:
        """Return the targets of the rows for values of the drives."""
        return np.concatenate([np.zeros(self.gaps), np.asarray(values, dtype=float)])

    def freest(self, direction: Array) -> list[str]:
        """Return the names of the coordinates that move most in a direction."""
        sizes = np.abs(direction)
        names = [self.positions.coordinates[k].name for k in self.moving]
        return [n for n, s in zip(names, sizes, strict=True) if s >= _NAMED * sizes.max()]


def mechanism(positions: Positions, driven: Sequence[str], hold: Sequence[str] = ()) -> Mechanism:
    """Return a system made ready to be swept.

    Coordinates that are declared independent or driven stay at their start unless they are
    drives themselves, or a drive has nothing else to move. Of the others, those that loops and
    drives leave free stay too.

    Parameters
    ----------
    positions
        The system.
    driven
        Names of the channels that are driven: coordinates or sensors.
    hold
        Names of coordinates that are to stay.

    Raises
    ------
    InputError
        If a name is unknown, a drive can move nothing or depends on the others.
    """
    names = [c.name for c in positions.channels]
    coordinates = [c.name for c in positions.coordinates]
    for name in driven:
        if name not in names:
            raise InputError(unknown_name("coordinate or sensor of positions", name, names))
    for name in hold:
        if name not in coordinates:
            raise InputError(unknown_name("coordinate", name, coordinates))
    if len(set(driven)) != len(driven):
        raise InputError("a channel is driven twice; name each drive once")
    drives = tuple(names.index(name) for name in driven)
    own = {coordinates.index(name) for name in driven if name in coordinates}
    stay = {coordinates.index(name) for name in hold}
    roles = [c.role for c in positions.coordinates]
    groups = [
        [k for k in sorted(own) if k not in stay],
        [k for k, r in enumerate(roles) if r == "dependent" and k not in own | stay],
        [k for k, r in enumerate(roles) if r == "auto" and k not in own | stay],
        [k for k, r in enumerate(roles) if r == "independent" and k not in own | stay],
    ]
    moving = _choose_moving(positions, drives, groups)
    settled = set(moving)
    held = tuple(coordinates[k] for group in groups for k in group if k not in settled) + tuple(
        hold
    )
    return Mechanism(positions, drives, tuple(sorted(moving)), held)


def _choose_moving(
    positions: Positions, drives: Sequence[int], groups: Sequence[Sequence[int]]
) -> list[int]:
    """Return as many coordinates as loops and drives determine, of the first groups first."""
    gaps = positions.jacobian(positions.start)
    rows = np.vstack([gaps, positions.slopes(positions.start)[list(drives)]])
    chosen: list[int] = []
    for group in groups:
        chosen += _independent(rows, chosen, list(group))
    if len(chosen) - _rank(gaps[:, chosen]) < len(drives):
        listed = ", ".join(f"'{positions.channels[k].name}'" for k in drives)
        raise InputError(
            f"the loops do not leave {listed} free to be driven at the start: too little freedom "
            "is left, or the place is singular; drive fewer channels, hold fewer coordinates, or "
            "start elsewhere"
        )
    return chosen


def _independent(rows: Array, chosen: list[int], group: list[int]) -> list[int]:
    """Return the columns of a group that are independent of the chosen ones."""
    rest = rows[:, group]
    if not rest.size:
        return []
    if chosen:
        basis = rows[:, chosen]
        rest = rest - basis @ np.linalg.lstsq(basis, rest, rcond=None)[0]
    _, triangle, order = qr(rest, mode="economic", pivoting=True)
    sizes = np.abs(np.diag(triangle))
    limit = _RANK * max(1.0, float(np.abs(rows).max()))
    return [group[int(k)] for k in order[: int(np.sum(sizes > limit))]]


def _rank(matrix: Array) -> int:
    if not matrix.size:
        return 0
    sizes = np.linalg.svd(matrix, compute_uv=False)
    return int(np.sum(sizes > _RANK * max(1.0, float(sizes.max()))))
