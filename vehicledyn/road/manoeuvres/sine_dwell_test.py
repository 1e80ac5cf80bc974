"""Sine with dwell by the steering wheel's angle, with the verdict of FMVSS 126 and UN R140."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from vehicledyn.base.parameters import quantity
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.manoeuvres.steering_signal import SteeringSignal, sine_with_dwell
from vehicledyn.road.manoeuvres.time_table import TimeTable
from vehicledyn.road.standards.signals import Signals

MOST_FIRST, MOST_SECOND = 0.35, 0.20
"""Limits of the yaw-rate ratios [1]."""

LEAST_DISPLACEMENT, LEAST_OF_HEAVY, HEAVY = 1.83, 1.52, 3500.0
"""Least displacement of cars up to a mass, and beyond it [m, m, kg]."""

_DISPLACED = 1.07


@dataclass(frozen=True)
class Verdict:
    """Yaw rates 1 s and 1.75 s after the end over their peak, and the displacement [m]."""

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


class SineDwellTest(DrivingTest):
    """One period of a sine of the steering wheel that waits at its second peak."""

    amplitude: float = quantity("rad", "Amplitude of the steering-wheel angle", gt=0)
    frequency: float = quantity("Hz", "Frequency", default=0.7, gt=0)
    dwell: float = quantity("s", "How long it waits", default=0.5, ge=0)

    def steering(self) -> SteeringSignal:
        """Return the sine with its dwell, from time zero on."""
        return sine_with_dwell(self.amplitude, self.frequency, self.dwell)

    def throttle(self) -> TimeTable:
        """Return the throttle, released with the steering: the car coasts through the test."""
        return TimeTable((0.0, 0.1), (1.0, 0.0))

    def verdict(self, signals: Signals) -> Verdict:
        """Return the quantities that decide; infinite ratios where the run ended before."""
        end = 1.0 / self.frequency + self.dwell
        reversed_at = 0.5 / self.frequency
        later = np.abs(signals.yaw_rate[signals.time >= reversed_at])
        last = float(signals.time[-1])
        if last < end + 1.75 or not later.size:
            return Verdict(math.inf, math.inf, math.nan)
        peak = float(later.max())
        first, second = (abs(signals.at("yaw_rate", end + after)) / peak for after in (1.0, 1.75))
        displacement = abs(signals.at("y", _DISPLACED) - signals.at("y", 0.0))
        return Verdict(first, second, displacement)
