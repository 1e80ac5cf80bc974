"""Single sine: one period of the steering wheel (ISO 7401)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres import figures
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.manoeuvres.steering_signal import SteeringSignal
from vehicledyn.road.standards.entries import entry

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.standards.signals import Signals
    from vehicledyn.road.vehicle import RoadVehicle

_ANSWERS = {"yaw_rate": "Yaw rate", "lateral_acceleration": "Lateral acceleration"}


@register("manoeuvre", "single_sine")
class SingleSine(DrivingTest):
    """Turn the steering wheel through one period of a sine.

    The summary has the lags of the first and second peak of yaw rate and lateral acceleration
    behind those of the steering wheel, and the gains of both peaks.

    References
    ----------
    ISO 7401, Road vehicles - Lateral transient response test methods - Open-loop test methods.
    """

    amplitude: float = quantity("rad", "Amplitude of the steering-wheel angle")
    frequency: float = quantity("Hz", "Frequency", default=0.5, gt=0)
    begin: float = quantity("s", "When the period begins", default=0.5, ge=0)

    def steering(self) -> SteeringSignal:
        """Return one period."""
        return SteeringSignal(
            amplitude=self.amplitude, frequency=self.frequency, cycles=1.0, hold_at=1e6,
            begin=self.begin,
        )  # fmt: skip

    def plots(self, vehicle: RoadVehicle) -> list[dict[str, Any]]:
        """Return the standard figures with the answers over one another."""
        return [figures.answers("Single sine"), *figures.standard(vehicle)]

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield the lags and gains of both halves."""
        from vehicledyn.road.standards.peaks import peak

        period = 1.0 / self.frequency
        if self.amplitude == 0.0 or signals.time[-1] < self.begin + 1.5 * period:
            return
        for index, half in enumerate(("first", "second")):
            steered = self.begin + (0.25 + 0.5 * index) * period
            window = signals.between(steered - 0.1 * period, steered + 0.5 * period)
            side = (1.0 if self.amplitude > 0.0 else -1.0) * (1.0 if index == 0 else -1.0)
            for name, text in _ANSWERS.items():
                at, largest = peak(window.time, side * getattr(window, name))
                gain, lag = largest / abs(self.amplitude), at - steered
                unit = "1/s" if name == "yaw_rate" else "m/s^2/rad"
                words = f"{text}: {half} peak over the steering amplitude"
                yield from entry(f"{name}_{half}_gain", gain, unit, words)
                words = f"{text}: {half} peak behind that of the steering wheel"
                yield from entry(f"{name}_{half}_lag", lag, "s", words)
