"""What decides a sine with dwell: yaw rates after it over their peak, and the displacement."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from vehicledyn.road.standards.signals import Floats

MOST_FIRST, MOST_SECOND = 0.35, 0.20
"""Limits of the yaw-rate ratios, S5.2.1 and S5.2.2 [1]."""

LEAST_DISPLACEMENT, LEAST_OF_HEAVY, HEAVY = 1.83, 1.52, 3500.0
"""Least displacement of cars up to a mass, and beyond it, S5.2.3 [m, m, kg]."""

FIRST_AFTER, SECOND_AFTER = 1.0, 1.75
"""Times after the completion of steer at which the yaw rate is judged [s]."""

DISPLACED_AFTER = 1.07
"""Time after the beginning of steer at which the displacement is judged [s]."""

STEER_BEGUN = math.radians(5.0)
"""Angle of the steering wheel that is the beginning of steer [rad]."""

_RIPPLE = 0.01
"""Part of a peak by which the yaw rate falls behind it; less is a ripple on the way [1]."""


@dataclass(frozen=True)
class Dwelling:
    """A sine with dwell by time: when it begins [s], its frequency [Hz] and its dwell [s].

    ``amplitude`` is that of the steering-wheel angle [rad]; none where there is no wheel.
    """

    begin: float
    frequency: float
    dwell: float
    amplitude: float | None

    @property
    def begun_at(self) -> float:
        """Beginning of steer: when the steering wheel passes 5 degrees [s]."""
        if self.amplitude is None or abs(self.amplitude) <= STEER_BEGUN:
            return self.begin
        phase = math.asin(STEER_BEGUN / abs(self.amplitude))
        return self.begin + phase / (2.0 * math.pi * self.frequency)

    @property
    def reversed_at(self) -> float:
        """When the steering wheel comes back through its middle [s]."""
        return self.begin + 0.5 / self.frequency

    @property
    def completed_at(self) -> float:
        """Completion of steer: when the wheel is back in its middle for good [s]."""
        return self.begin + 1.0 / self.frequency + self.dwell


@dataclass(frozen=True)
class Verdict:
    """Yaw rates 1 s and 1.75 s after the end over their peak, and the displacement [m].

    NaN is what the run was too short for. A ratio is infinite where the yaw rate never follows
    the reversed steering, as that of a car which spins in the first half.
    """

    first_ratio: float
    second_ratio: float
    displacement: float

    @property
    def is_stable(self) -> bool:
        """Whether the yaw rate falls as it must."""
        return self.first_ratio <= MOST_FIRST and self.second_ratio <= MOST_SECOND

    def is_responsive(self, mass: float) -> bool:
        """Return whether a car of a mass [kg] moves aside as far as it must."""
        least = LEAST_DISPLACEMENT if mass <= HEAVY else LEAST_OF_HEAVY
        return self.displacement >= least


def judged(time: Floats, yaw_rate: Floats, y: Floats, given: Dwelling) -> Verdict:
    """Return what decides, from samples by time.

    Parameters
    ----------
    time, yaw_rate, y
        Time [s], yaw rate [rad/s] and lateral position of the centre of mass [m].
    given
        The steering.

    References
    ----------
    49 CFR 571.126 (FMVSS 126), S5.2 and S7.11: the peak is the first local one that the reversal
    of the steering wheel makes, of that direction; the displacement counts from where the wheel
    passes 5 degrees.
    """
    peak = reversed_peak(time, yaw_rate, given.reversed_at)

    def ratio(after: float) -> float:
        at = given.completed_at + after
        if time[-1] < at:
            return math.nan
        return abs(float(np.interp(at, time, yaw_rate))) / peak if peak > 0.0 else math.inf

    start, end = given.begun_at, given.begun_at + DISPLACED_AFTER
    before, moved = np.interp([start, end], time, y)
    aside = abs(float(moved - before)) if time[-1] >= end else math.nan
    return Verdict(ratio(FIRST_AFTER), ratio(SECOND_AFTER), aside)


def reversed_peak(time: Floats, yaw_rate: Floats, reversed_at: float) -> float:
    """Return the first local peak of the yaw rate after the steering's reversal [rad/s].

    It counts against the direction of the first half; zero or less where there is none.
    """
    first = yaw_rate[time <= reversed_at]
    direction = -np.sign(first[int(np.abs(first).argmax())]) if first.size else 1.0
    peak = 0.0
    for rate in direction * yaw_rate[time >= reversed_at]:
        if peak > 0.0 and rate < (1.0 - _RIPPLE) * peak:
            break
        peak = max(peak, float(rate))
    return peak
