"""Conditions of a driving test (ISO 15037-1): a steady start, and a speed that is held.

The tolerance of the speed is that of FMVSS 126 and UN R140 for 80 km/h; those of the start are the
program's own, of the size of what a measuring vehicle resolves.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from vehicledyn.base.units import shown
from vehicledyn.road.standards.signals import Signals

SPEED = 2.0 / 3.6
"""Largest departure from the test's speed [m/s]."""
WINDOW = 0.5
"""Time before the input in which the motion must be steady [s]."""

_JUST = 1e-6
"""How long before the input the last sample lies at least [s]."""

_STEADY = (
    ("speed", "m/s", "speed", SPEED),
    ("yaw_rate", "rad/s", "yaw rate", math.radians(0.5)),
    ("lateral_acceleration", "m/s^2", "lateral acceleration", 0.3),
)
"""Signals before the input with the largest range that counts as steady."""


def start_remarks(signals: Signals, at: float) -> Iterator[str]:
    """Yield what is not steady in the half second before the input.

    Parameters
    ----------
    signals
        Signals of the whole test.
    at
        When steering, brakes or wind begin [s].
    """
    # A sample at the input itself may hold what a jump of it does at once.
    before = signals.between(at - WINDOW, at - _JUST)
    for name, unit, text, most in _STEADY if len(before.time) > 1 else ():
        moved = float(np.ptp(getattr(before, name)))
        if moved > most:
            yield (
                f"the start is not steady: the {text} changes by {shown(moved, unit)} in the "
                f"{WINDOW:g} s before the input (ISO 15037-1, initial driving condition)"
            )


def speed_remarks(signals: Signals) -> Iterator[str]:
    """Yield where the speed leaves that of the start by more than 2 km/h."""
    apart = signals.speed - signals.speed[0]
    beyond = np.abs(apart) > SPEED
    if beyond.any():
        worst = float(apart[np.argmax(np.abs(apart))])
        yield (
            f"the speed departs from {3.6 * signals.speed[0]:.4g} km/h by up to "
            f"{3.6 * worst:.3g} km/h, by more than {3.6 * SPEED:g} km/h from "
            f"t = {signals.time[np.argmax(beyond)]:.3g} s on"
        )
