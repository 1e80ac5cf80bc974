"""The loop of an answer over a slowly swinging steering angle (ISO 13674-1)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vehicledyn.road.standards.signals import Floats


@dataclass(frozen=True)
class Loop:
    """Of one period: slope at zero angle, height and width of the loop there, and time lag [s]."""

    gain: float
    height: float
    width: float
    lag: float


def loop_of(time: Floats, angle: Floats, answer: Floats, frequency: float) -> Loop:
    """Return the quantities of one period of an answer, its first harmonic's lag included.

    The slope is that of a line through all points whose angle is within a fifth of the largest;
    height and width are the distances of rising and falling branch on the axes.
    """
    small = np.abs(angle) <= 0.2 * np.abs(angle).max()
    gain = float(np.polyfit(angle[small], answer[small], 1)[0])
    height = _opening(angle, answer)
    width = _opening(answer, angle)
    turns = np.exp(-2j * np.pi * frequency * time)
    phase = np.angle(np.sum(turns[:-1] * answer[:-1]) / np.sum(turns[:-1] * angle[:-1]))
    return Loop(gain, height, width, float(-phase / (2.0 * np.pi * frequency)))


def _opening(along: Floats, values: Floats) -> float:
    """Return how far values differ where ``along`` crosses zero both ways; NaN if it does not."""
    rising: list[float] = []
    falling: list[float] = []
    for k in range(len(along) - 1):
        a, b = along[k], along[k + 1]
        if a * b <= 0.0 and a != b:
            value = values[k] + (values[k + 1] - values[k]) * a / (a - b)
            (rising if b > a else falling).append(float(value))
    if not rising or not falling:
        return float("nan")
    return abs(float(np.mean(rising)) - float(np.mean(falling)))
