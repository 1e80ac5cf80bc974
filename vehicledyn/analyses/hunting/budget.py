"""How much a hunting study computes if nobody says: cycles that are followed, motion simulated.

What it costs is foreseen from operations, the fastest eigenvalue and the period, so that the same
study does the same everywhere.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from vehicledyn.analyse.periodic.critical import CriticalPoint, Hopf
from vehicledyn.analyse.settling.simulated_cycles import STIFF
from vehicledyn.analyses.hunting.start import HuntSettings, simulated_seconds
from vehicledyn.kernel.kernel import Kernel

_SIMULATING, _FOLLOWING = 25.0, 45.0
"""Seconds of processor time that simulations and following branches take at most, roughly."""

_CALL, _OPERATION, _ITERATIONS, _STAGES = 5e-8, 1e-10, 8, 4
"""Seconds that rates take, and one of their operations; how often loops are corrected, and how
often rates are evaluated in a step."""

_CYCLE, _PERIODS = 0.1, 16.0
"""Seconds that a cycle takes at least, and periods of simulated motion that cost as much."""

_STATES = 50.0
"""States whose tangents along a cycle cost as much as the cycle; those of more grow as squares."""

FEWEST_CYCLES = 12
"""Cycles that any branch may have."""

_POINTS, _FEWEST_POINTS = 60, 8
_PASSES, _LEAST_CYCLES, _LEAST_FURTHER = 3, 120, 40
"""How often a branch may pass the range, cycles that it may have at least where points are asked
for, and those that branches from simulated cycles may have together then."""


@dataclass(frozen=True)
class Budget:
    """What a study may compute.

    ``points`` is about the number of cycles on one way of a branch through the range, ``cycles``
    the largest number on a branch, ``further`` that on all branches that begin at simulated
    cycles, ``seconds`` how much motion is simulated [s]; ``each`` is how long a cycle is expected
    to take [s].
    """

    points: int
    cycles: int
    further: int
    seconds: float
    each: float


def budget_of(
    settings: HuntSettings, kernel: Kernel, balances: Sequence[CriticalPoint], hopfs: Sequence[Hopf]
) -> Budget:
    """Return what is asked for, or where nothing is what suits the model."""
    cost = _cost_of_motion(kernel, balances)
    period = max((2.0 * math.pi / h.frequency for h in hopfs), default=0.0)
    states = len(balances[0].state)
    each = _CYCLE + _PERIODS * cost * period * (1.0 + (states / _STATES) ** 2)
    seconds = simulated_seconds(settings) or _SIMULATING / cost
    if settings.points is not None:
        points = settings.points
        cycles = max(_PASSES * points, _LEAST_CYCLES)
        return Budget(points, cycles, max(points, _LEAST_FURTHER), seconds, each)
    cycles = min(_PASSES * _POINTS, max(int(_FOLLOWING / each), FEWEST_CYCLES))
    points = max(_FEWEST_POINTS, cycles // _PASSES)
    return Budget(points, cycles, min(_POINTS, cycles // 2), seconds, each)


def _cost_of_motion(kernel: Kernel, balances: Sequence[CriticalPoint]) -> float:
    """Return the seconds of processor time that a second of motion takes to simulate, roughly."""
    operations = kernel.report.operations
    rates = operations["rates"] + _ITERATIONS * operations["blocks"]
    fastest = float(np.median([np.abs(b.eigenvalues).max() for b in balances]))
    return float(_STAGES * fastest / STIFF * (_CALL + _OPERATION * rates))
