"""Swept sine: the steering wheel swings with a growing frequency (ISO 7401)."""

from __future__ import annotations

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres.frequency_test import FrequencyTest
from vehicledyn.road.manoeuvres.steering_signal import SteeringSignal


@register("manoeuvre", "swept_sine")
class SweptSine(FrequencyTest):
    """Swing the steering wheel with a frequency that grows linearly with time.

    The sweep ends at the last zero of its last period; the run should go on for some seconds.

    References
    ----------
    ISO 7401, Road vehicles - Lateral transient response test methods - Open-loop test methods.
    """

    amplitude: float = quantity("rad", "Amplitude of the steering-wheel angle")
    first: float = quantity("Hz", "Frequency at the begin", default=0.1, gt=0)
    last: float = quantity("Hz", "Frequency at the end", default=2.5, gt=0)
    sweep_time: float = quantity("s", "How long the frequency grows", default=40.0, gt=0)
    begin: float = quantity("s", "When the sweep begins", default=0.5, ge=0)

    def steering(self) -> SteeringSignal:
        """Return the sweep."""
        rate = (self.last - self.first) / self.sweep_time
        turns = 0.5 * (self.first + self.last) * self.sweep_time
        return SteeringSignal(
            amplitude=self.amplitude, frequency=self.first, sweep_rate=rate,
            cycles=float(round(turns)), hold_at=1e6, begin=self.begin,
        )  # fmt: skip
