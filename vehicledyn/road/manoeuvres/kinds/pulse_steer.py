"""Pulse steer: half a period of a sine of the steering wheel (ISO 7401)."""

from __future__ import annotations

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres.frequency_test import FrequencyTest
from vehicledyn.road.manoeuvres.steering_signal import SteeringSignal


@register("manoeuvre", "pulse_steer")
class PulseSteer(FrequencyTest):
    """Turn the steering wheel through half a period of a sine, and hold it in the middle.

    References
    ----------
    ISO 7401, Road vehicles - Lateral transient response test methods - Open-loop test methods.
    """

    amplitude: float = quantity("rad", "Largest steering-wheel angle")
    width: float = quantity("s", "How long the pulse lasts", default=0.3, gt=0)
    begin: float = quantity("s", "When the pulse begins", default=0.5, ge=0)

    def steering(self) -> SteeringSignal:
        """Return the pulse."""
        return SteeringSignal(
            amplitude=self.amplitude, frequency=0.5 / self.width, cycles=0.5, hold_at=1e6,
            begin=self.begin,
        )  # fmt: skip
