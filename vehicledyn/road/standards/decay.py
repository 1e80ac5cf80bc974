"""Damping of an oscillation that dies out, or grows, from its extremes (ISO 9815)."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from vehicledyn.road.standards.signals import Floats

FEWEST_EXTREMES = 4


@dataclass(frozen=True)
class Decay:
    """Damping ratio, negative where the oscillation grows, and frequency [Hz]; NaN if unknown."""

    damping_ratio: float
    frequency: float


def decay_of(time: Floats, values: Floats) -> Decay:
    """Return damping and frequency of the oscillation a exp(-σ t) cos(ω t + φ) + offset.

    Differences of neighbouring extremes have no offset; the straight line through their
    logarithms falls by σ, and ω is π over the time between them.

    Parameters
    ----------
    time, values
        Samples of the free oscillation [s, any]; extremes are those of parabolas through three.
    """
    places, heights = _extremes(time, values)
    if len(places) < FEWEST_EXTREMES:
        return Decay(math.nan, math.nan)
    strokes = np.abs(np.diff(heights))
    sigma = -float(np.polyfit(places[:-1], np.log(strokes), 1)[0])
    omega = math.pi * (len(places) - 1) / float(places[-1] - places[0])
    return Decay(sigma / math.hypot(sigma, omega), omega / (2.0 * math.pi))


def _extremes(time: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Return times and values of the extremes inside."""
    slopes = np.diff(values)
    at = np.flatnonzero(slopes[:-1] * slopes[1:] < 0.0) + 1
    before, here, after = values[at - 1], values[at], values[at + 1]
    shift = 0.5 * (before - after) / (before - 2.0 * here + after)
    step = time[at + 1] - time[at]
    return time[at] + shift * step, here - 0.25 * (before - after) * shift
