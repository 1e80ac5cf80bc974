"""Constant steering wheel: the speed grows slowly on a held steering-wheel angle (ISO 4138)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres import figures
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.manoeuvres.steering_signal import SteeringSignal, ramp_and_hold
from vehicledyn.road.manoeuvres.time_table import TimeTable
from vehicledyn.road.standards.entries import entry

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.standards.signals import Signals
    from vehicledyn.road.vehicle import RoadVehicle


@register("manoeuvre", "constant_steer")
class ConstantSteer(DrivingTest):
    """Hold the steering wheel while the speed grows slowly.

    The summary has the understeer gradient: by what the path straightens, L (1/R_0 - 1/R) over
    lateral acceleration, up to 4 m/s².

    References
    ----------
    ISO 4138, Passenger cars - Steady-state circular driving behaviour - Open-loop test methods,
    constant-steering-wheel-angle method.
    """

    angle: float = quantity("rad", "Steering-wheel angle to the left")
    rate: float = quantity("rad/s", "Rate of the steering wheel", default=0.3, gt=0)
    begin: float = quantity("s", "When the wheel begins to turn", default=0.5, ge=0)
    accelerate_at: float = quantity("s", "When the speed begins to grow", default=5.0, gt=0)
    acceleration: float = quantity("m/s^2", "Growth of the speed", default=0.2, gt=0)
    last_speed_change: float = quantity("m/s", "Speed gained in the end", gt=0)

    def steering(self) -> SteeringSignal:
        """Return the ramp and its hold."""
        return ramp_and_hold(self.angle, self.rate, self.begin)

    def speed_change(self) -> TimeTable:
        """Return the slow growth of the target speed."""
        end = self.accelerate_at + self.last_speed_change / self.acceleration
        return TimeTable((self.accelerate_at, end), (0.0, self.last_speed_change))

    def plots(self, vehicle: RoadVehicle) -> list[dict[str, Any]]:
        """Return the standard figures with the answers over one another."""
        return [figures.answers("Constant steering-wheel angle"), *figures.standard(vehicle)]

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield the understeer gradient."""
        from vehicledyn.road.standards.gradients import initial_gradient

        sign = 1.0 if self.angle >= 0.0 else -1.0
        later = signals.between(self.accelerate_at + 1.0, float(signals.time[-1]))
        if len(later.time) < 2:
            return
        lateral = sign * later.lateral_acceleration
        try:
            slope = initial_gradient(lateral, sign * later.understeer, 4.0)
        except InputError:
            return
        words = "Understeer angle at the front wheels over lateral acceleration, up to 4 m/s^2"
        yield from entry("understeer_gradient", slope, "rad*s^2/m", words)
