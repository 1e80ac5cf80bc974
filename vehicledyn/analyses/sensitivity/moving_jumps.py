"""Jumps of channels at events, whose moving instants the samples of a run do not show.

The integral of a channel that jumps by Δ at an instant t changes by -Δ dt/dp as that moves. Samples
keep their times, so that the derivatives of their sums leave this out however near they lie.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.motion_slopes import EventSlope, MotionSlopes

Floats = NDArray[np.float64]

_STEEP = 2.0
"""How many times a jump is larger than the changes from sample to sample beside it."""
_FELT = 0.01
"""Part of the largest effect of a parameter by which one is changed, for a warning."""


def moving_jump(
    motion: MotionSlopes, kind: str, place: int, slope: Floats, moves: Floats
) -> tuple[EventSlope, float] | None:
    """Return the event whose jump changes the derivatives of a sum most, and by which part.

    None where no jump is felt.

    Parameters
    ----------
    motion
        The motion with its derivatives.
    kind, place
        Figure of a channel, one of ``mean``, ``mean_square``, ``rms`` and ``integral``; the place
        of the channel.
    slope
        Derivatives of the figure (n_directions,).
    moves
        Changes of the directions by which effects are compared (n_directions,).
    """
    times, values = motion.times, motion.values[:, place]
    squared = kind in ("mean_square", "rms")
    summed, size = values**2 if squared else values, 1.0
    if kind != "integral":
        size = float(times[-1] - times[0])
    if kind == "rms":
        size *= 2.0 * float(np.sqrt(np.mean(values**2)))
    largest = float(np.max(np.abs(slope * moves), initial=0.0))
    worst: tuple[EventSlope, float] | None = None
    for event in motion.events:
        behind = int(np.searchsorted(times, event.time))
        if not 2 <= behind <= len(times) - 2:
            continue
        steps = np.diff(summed[behind - 2 : behind + 2])
        jump = float(steps[1] - 0.5 * (steps[0] + steps[2]))
        if abs(jump) <= _STEEP * max(abs(steps[0]), abs(steps[2])):
            continue
        effect = float(np.max(np.abs(jump * event.slope * moves), initial=0.0))
        if effect > _FELT * largest * size and effect > 0.0:
            part = effect / (largest * size) if largest else np.inf
            worst = max(worst or (event, 0.0), (event, part), key=lambda item: item[1])
    return worst
