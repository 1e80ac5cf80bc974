"""Find the cycles of a branch at a value of the parameter."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from itertools import pairwise

import numpy as np

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.collocation import Scales, correct
from vehicledyn.analyse.periodic.cycle_points import Branch, CyclePoint, ahead
from vehicledyn.analyse.periodic.floquet import multipliers_of
from vehicledyn.analyse.periodic.multiple_shooting import Closed, closed
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.analyse.periodic.single_shooting import returning
from vehicledyn.base.errors import NumericalError

_FARTHEST = 0.4
"""Largest way along the branch that a guess is carried."""


def points_beside(branch: Branch, value: float) -> list[CyclePoint]:
    """Return the points of a branch that are next to a value of the parameter, in its order."""
    found: list[CyclePoint] = []
    for before, after in pairwise(branch.points):
        ends = before.orbit.parameter, after.orbit.parameter
        is_end = (before is branch.points[0] and value == ends[0]) or (
            after is branch.points[-1] and value == ends[1]
        )
        if min(ends) <= value < max(ends) or is_end:
            found.append(min((before, after), key=lambda p: abs(p.orbit.parameter - value)))
    return found


def cycle_beside(model: AutonomousField, near: CyclePoint, value: float) -> CyclePoint:
    """Return the cycle at a value of the parameter beside one of the branch.

    Raises
    ------
    NumericalError
        If it is not found.
    """
    return model.memory.recall_or_raise(
        "cycle_beside", (near, value), lambda: _beside(model, near, value)
    )


def _beside(model: AutonomousField, near: CyclePoint, value: float) -> CyclePoint:
    guess = _guess(near, value)
    exact = _shot(model, guess, near) if model.is_carried else None
    if exact is None:
        scales = Scales(guess.scales(), guess.period, abs(value) or 1.0)
        exact = closed(model, correct(model, guess, scales, along=None).orbit)
    values = multipliers_of(exact.passages)
    return CyclePoint(exact.orbit, values, near.tangent, exact.iterations)


def _guess(near: CyclePoint, value: float) -> Orbit:
    """Return the orbit ahead of another along its branch, or that itself where it is far."""
    slope = near.tangent.parameter
    reach = (value - near.orbit.parameter) / slope if slope else np.inf
    guess = ahead(near.orbit, near.tangent, reach if abs(reach) < _FARTHEST else 0.0)
    return replace(guess, parameter=value)


def _shot(model: AutonomousField, guess: Orbit, near: CyclePoint) -> Closed | None:
    """Return an orbit by integration alone, None where it is not found."""
    known = near.passages
    if known is not None:
        with suppress(NumericalError):
            return returning(model, guess, known, mirror=known.mirror)
    try:
        return closed(model, guess)
    except NumericalError:
        return None
