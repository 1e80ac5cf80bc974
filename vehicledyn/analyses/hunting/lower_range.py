"""The range of a study below its lowest value, where an oscillation grows there already.

Where it begins to grow, a branch of cycles begins that may lead into the range.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.critical import CriticalPoint, ahead, find_hopf
from vehicledyn.analyses.hunting.equilibria import Equilibria
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.units import shown
from vehicledyn.kernel.engine import Vector

_LOWEST = 0.5
"""Part of a range's lower end down to which equilibria are looked for [1]."""

_STEPS = 40
"""Equilibria on the longer of the range and the way below it."""


class FurtherRange(NamedTuple):
    """Equilibria beside a range, up to where an oscillation begins to grow, and a message."""

    balances: list[CriticalPoint]
    words: str


def lower_range(equilibria: Equilibria, span: tuple[float, float], unit: str) -> FurtherRange:
    """Return equilibria from where the oscillation decays that grows at a range's lower end.

    There are none where that lies more than half the way to zero below it.
    """
    first, name = equilibria.balances[0], equilibria.starts.name
    lowest = _LOWEST * span[0] if span[0] > 0.0 else span[0]
    step = max((span[1] - span[0]) / _STEPS, (span[0] - lowest) / _STEPS)
    found = [first]
    try:
        while found[-1].growing_pairs and found[-1].value > lowest:
            value = max(found[-1].value - step, lowest)
            found.append(equilibria.at(value, *ahead(equilibria.model, found[-1], value)))
    except NumericalError:
        pass
    ordered = found[::-1]
    frequency = abs(float(_growing(equilibria.model, first)[0].imag)) / (2.0 * math.pi)
    start = f"an oscillation of {frequency:.4g} Hz grows at {name} = {shown(span[0], unit)} already"
    hopfs = find_hopf(equilibria.model, ordered, equilibria.at)
    if not hopfs or ordered[0].growing_pairs:
        reached = shown(ordered[0].value, unit)
        words = f"{start}, and at all values down to {reached}: the linear critical value is lower"
        return FurtherRange([], words)
    where = ", ".join(shown(hopf.balance.value, unit) for hopf in hopfs)
    begin = shown(ordered[0].value, unit)
    return FurtherRange(
        ordered[:-1],
        f"{start}; oscillations begin to grow at {where}, below the range asked for, which is "
        f"followed from {begin} on",
    )


def growing_shape(model: AutonomousField, balance: CriticalPoint) -> Vector:
    """Return the shape of the oscillation that grows fastest, complex, shape (n_kept,)."""
    return _growing(model, balance)[1]


def _growing(model: AutonomousField, balance: CriticalPoint) -> tuple[complex, Vector]:
    """Return eigenvalue and shape of the oscillation that grows fastest."""
    found = model.evaluate(balance.state[None], balance.unknowns[None], balance.value)
    values, vectors = np.linalg.eig(found.by_state[0])
    chosen = int(np.argmax(np.where(values.imag > 0.0, values.real, -np.inf)))
    return complex(values[chosen]), np.asarray(vectors[:, chosen])
