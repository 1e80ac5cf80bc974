"""Step steer: a quick ramp of the steering wheel, then held (ISO 7401)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres import figures
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.manoeuvres.steering_signal import SteeringSignal, ramp_and_hold
from vehicledyn.road.standards.entries import entry

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.standards.signals import Signals
    from vehicledyn.road.vehicle import RoadVehicle

_ANSWERS = {
    "yaw_rate": ("Yaw rate", "rad/s"),
    "lateral_acceleration": ("Lateral acceleration", "m/s^2"),
    "roll": ("Roll angle", "rad"),
}
_SETTLED = 0.8
"""Part of the time after the step whose end counts as steady [1]."""


@register("manoeuvre", "step_steer")
class StepSteer(DrivingTest):
    """Turn the steering wheel quickly to an angle and hold it.

    The summary has, for yaw rate, lateral acceleration and roll angle, the steady value, response
    time, peak time and overshoot, and the product TB of steady side-slip angle and peak time of the
    yaw rate. Times count from when half of the steering angle is reached, a response ends at 90 %
    of the steady value, the mean of the last fifth of the run after the step.

    References
    ----------
    ISO 7401, Road vehicles - Lateral transient response test methods - Open-loop test methods.
    """

    angle: float = quantity("rad", "Steering-wheel angle to the left")
    rate: float = quantity("rad/s", "Rate of the steering wheel", default=8.726646259971648, gt=0)
    begin: float = quantity("s", "When the step begins", default=0.5, ge=0)

    def steering(self) -> SteeringSignal:
        """Return the ramp and its hold."""
        return ramp_and_hold(self.angle, self.rate, self.begin)

    def plots(self, vehicle: RoadVehicle) -> list[dict[str, Any]]:
        """Return the standard figures with the answers over one another."""
        return [figures.answers("Step steer"), *figures.standard(vehicle)]

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield the quantities of ISO 7401's step."""
        from vehicledyn.road.standards.step_response import half_of_step, step_response

        end = self.begin + abs(self.angle / self.rate)
        if self.angle == 0.0 or signals.time[-1] <= end:
            return
        reference = half_of_step(signals.time, signals.steering)
        settled = end + _SETTLED * (float(signals.time[-1]) - end)
        yield from entry(
            "steering_angle", float(signals.steering[-1]), "rad", "Steering angle held"
        )
        found = {}
        for name, (text, unit) in _ANSWERS.items():
            answer = found[name] = step_response(
                signals.time, getattr(signals, name), reference=reference, settled=settled
            )
            yield from entry(f"{name}_steady", answer.steady, unit, f"{text}, steady")
            words = f"{text}: from half of the step to 90 % of the steady value"
            yield from entry(f"{name}_response_time", answer.response_time, "s", words)
            words = f"{text}: from half of the step to the peak"
            yield from entry(f"{name}_peak_time", answer.peak_time, "s", words)
            words = f"{text}: peak over steady value, less one"
            yield from entry(f"{name}_overshoot", answer.overshoot, "1", words)
        slip = float(signals.sideslip[signals.time >= settled].mean())
        yield from entry("sideslip_steady", slip, "rad", "Side-slip angle, steady")
        product = abs(slip) * found["yaw_rate"].peak_time
        words = "TB: steady side-slip angle times peak time of the yaw rate"
        yield from entry("sideslip_times_peak_time", product, "rad*s", words)
