"""Sine with dwell by the steering wheel's angle, with the verdict of FMVSS 126 and UN R140."""

from __future__ import annotations

import numpy as np

from vehicledyn.base.parameters import quantity
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.manoeuvres.steering_signal import SteeringSignal, sine_with_dwell
from vehicledyn.road.manoeuvres.time_table import TimeTable
from vehicledyn.road.standards.signals import Signals
from vehicledyn.road.standards.sine_dwell import Dwelling, Verdict, judged


class SineDwellTest(DrivingTest):
    """One period of a sine of the steering wheel that waits at its second peak."""

    amplitude: float = quantity("rad", "Amplitude of the steering-wheel angle, first to the left")
    frequency: float = quantity("Hz", "Frequency", default=0.7, gt=0)
    dwell: float = quantity("s", "How long it waits", default=0.5, ge=0)

    def steering(self) -> SteeringSignal:
        """Return the sine with its dwell, from time zero on."""
        return sine_with_dwell(self.amplitude, self.frequency, self.dwell)

    def throttle(self) -> TimeTable:
        """Return the throttle, released with the steering: the car coasts through the test."""
        return TimeTable((0.0, 0.1), (1.0, 0.0))

    def verdict(self, signals: Signals, *, ahead: float, has_wheel: bool) -> Verdict:
        """Return the quantities that decide.

        Parameters
        ----------
        signals
            What was recorded.
        ahead
            Distance of the centre of mass ahead of the chassis's origin [m].
        has_wheel
            Whether the amplitude is that of a steering wheel.
        """
        amplitude = self.amplitude if has_wheel else None
        given = Dwelling(0.0, self.frequency, self.dwell, amplitude)
        aside = signals.y + ahead * np.sin(signals.yaw)
        return judged(signals.time, signals.yaw_rate, aside, given)
