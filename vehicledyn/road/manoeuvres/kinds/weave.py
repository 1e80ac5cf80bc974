"""Weave: a slow small sine of the steering wheel, for the on-centre feel (ISO 13674)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from pydantic import Field

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


@register("manoeuvre", "weave")
class Weave(DrivingTest):
    """Swing the steering wheel slowly through a few small periods at a motorway's speed.

    The summary has, over the last whole period, the gain of yaw rate and lateral acceleration at
    zero steering angle, the dead band and hysteresis of lateral acceleration over steering angle,
    and the phase lags. Torques need a model with a steering wheel and are left to its channels.

    References
    ----------
    ISO 13674-1, Road vehicles - Test method for the quantification of on-centre handling - Weave
    test.
    """

    amplitude: float = quantity("rad", "Amplitude of the steering-wheel angle")
    frequency: float = quantity("Hz", "Frequency", default=0.2, gt=0)
    periods: int = Field(default=3, description="Number of periods", ge=1, le=1000)
    begin: float = quantity("s", "When the weave begins", default=0.5, ge=0)

    def steering(self) -> SteeringSignal:
        """Return the sine."""
        return SteeringSignal(
            amplitude=self.amplitude, frequency=self.frequency, cycles=float(self.periods),
            hold_at=1e6, begin=self.begin,
        )  # fmt: skip

    def plots(self, vehicle: RoadVehicle) -> list[dict[str, Any]]:
        """Return the standard figures with the answers over one another."""
        return [figures.answers("Weave"), *figures.standard(vehicle)]

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield gains, hysteresis and lags of the last period."""
        from vehicledyn.road.standards.hysteresis import loop_of

        end = self.begin + self.periods / self.frequency
        if self.amplitude == 0.0 or signals.time[-1] < end - 1e-9:
            return
        last = signals.between(end - 1.0 / self.frequency, end)
        if last.time.size < _FEWEST:
            return
        for name, unit, text in _ANSWERS:
            loop = loop_of(last.time, last.steering, getattr(last, name), self.frequency)
            yield from entry(
                f"{name}_gain",
                loop.gain,
                f"{unit}/rad",
                f"{text} over steering angle, slope through zero angle",
            )
            yield from entry(
                f"{name}_hysteresis",
                loop.height,
                unit,
                f"{text}: height of the loop at zero steering angle",
            )
            yield from entry(
                f"{name}_dead_band",
                loop.width,
                "rad",
                f"Steering angle: width of the loop at no {text.lower()}",
            )
            yield from entry(
                f"{name}_lag",
                loop.lag,
                "s",
                f"{text}: lag of its first harmonic behind the steering angle",
            )


_FEWEST = 8
"""Samples of a period from which on it has a loop."""
_ANSWERS = (
    ("yaw_rate", "rad/s", "Yaw rate"),
    ("lateral_acceleration", "m/s^2", "Lateral acceleration"),
)
