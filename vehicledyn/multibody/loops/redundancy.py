"""Multipliers that are not unique: the self-stresses of redundant constraints.

Where rows of the Jacobian depend on each other, S J = 0, any multiple of a row of S may be added
to the multipliers without any effect on the motion. What such a self-stress changes cannot be
determined from rigid bodies; all else can.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.multibody.loops.configuration import LoopAssembly
from vehicledyn.multibody.loops.partition import RANK_TOLERANCE

Array = NDArray[np.float64]

NEGLIGIBLE = 1e-8
"""Share of a self-stress, relative to the largest, that counts as none [1]."""


@dataclass(frozen=True)
class SelfStress:
    """Multipliers that keep the system at rest without any load, at one configuration.

    ``time`` [s] and ``coordinates`` say where, ``multipliers`` has a row an independent
    self-stress and a column a row of the constraints.
    """

    time: float
    coordinates: Array
    multipliers: Array

    @property
    def rows(self) -> list[int]:
        """Rows of the constraints that are part of a self-stress."""
        return [int(k) for k in np.flatnonzero((np.abs(self.multipliers) > NEGLIGIBLE).any(axis=0))]


def self_stresses(place: LoopAssembly, q: Array) -> tuple[SelfStress, ...]:
    """Return the self-stresses at a configuration and, if it can move, a little further on.

    A share that vanishes by accident at one of them does not at the other.
    """
    near = place.nearby(q)
    return tuple(_self_stress(place, at) for at in (q, near) if at is not None)


def _self_stress(place: LoopAssembly, q: Array) -> SelfStress:
    moving = place.columns("auto", "dependent", "independent")
    jacobian = place.gaps.jacobian(place.time, q)[:, moving]
    left, sizes, _ = np.linalg.svd(jacobian)
    limit = RANK_TOLERANCE * max(1.0, float(sizes.max(initial=0.0)))
    return SelfStress(place.time, q, left[:, int(np.sum(sizes > limit)) :].T)
