"""Braking in a turn: brakes are applied on a steady circle, the steering wheel held (ISO 7975)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

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


@register("manoeuvre", "braking_in_turn")
class BrakingInTurn(DrivingTest):
    """Drive a steady circle, release the throttle and apply the brakes with the wheel held.

    With no brake torque it is the power-off test of ISO 9816. The summary has the mean
    deceleration, and 1 s after the brakes begin the yaw rate over that of the steady circle, the
    yaw rate over what the same circle needs at the fallen speed, the change of the side-slip angle
    and the departure from the circle.

    References
    ----------
    ISO 7975, Passenger cars - Braking in a turn - Open-loop test method. ISO 9816, Passenger cars -
    Power-off reactions of a vehicle in a turn - Open-loop test method.
    """

    angle: float = quantity("rad", "Steering-wheel angle to the left")
    rate: float = quantity("rad/s", "Rate of the steering wheel", default=0.5, gt=0)
    begin: float = quantity("s", "When the wheel begins to turn", default=0.5, ge=0)
    brake_at: float = quantity("s", "When the brakes begin", default=8.0, gt=0)
    torque: float = quantity("N*m", "Brake torque of all wheels together", ge=0)
    build_up: float = quantity("s", "How long the torque takes to grow", default=0.3, gt=0)

    def steering(self) -> SteeringSignal:
        """Return the ramp and its hold."""
        return ramp_and_hold(self.angle, self.rate, self.begin)

    def throttle(self) -> TimeTable:
        """Return the throttle, released when the brakes begin."""
        return TimeTable((self.brake_at, self.brake_at + 0.1), (1.0, 0.0))

    def brake_torque(self) -> TimeTable:
        """Return the brake torque, which grows and stays."""
        return TimeTable((self.brake_at, self.brake_at + self.build_up), (0.0, self.torque))

    def plots(self, vehicle: RoadVehicle) -> list[dict[str, Any]]:
        """Return the standard figures with the answers over one another."""
        return [figures.answers("Braking in a turn"), *figures.standard(vehicle)]

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield the reactions 1 s after the brakes begin."""
        later = self.brake_at + _JUDGED
        if signals.time[-1] < later or self.angle == 0.0:
            return
        rate, then = signals.at("yaw_rate", self.brake_at), signals.at("yaw_rate", later)
        speed, slower = (
            signals.at("forward_speed", self.brake_at),
            signals.at("forward_speed", later),
        )
        yield from entry(
            "lateral_acceleration_before",
            rate * speed,
            "m/s^2",
            "Lateral acceleration of the steady circle",
        )
        yield from entry(
            "mean_deceleration",
            (speed - slower) / _JUDGED,
            "m/s^2",
            "Mean deceleration in the first second",
        )
        yield from entry(
            "yaw_rate_ratio", then / rate, "1", "Yaw rate after 1 s over that of the steady circle"
        )
        yield from entry(
            "yaw_rate_ratio_to_circle",
            then / rate * speed / slower,
            "1",
            "Yaw rate after 1 s over what the same circle needs at that speed",
        )
        change = signals.at("sideslip", later) - signals.at("sideslip", self.brake_at)
        yield from entry("sideslip_change", change, "rad", "Change of the side-slip angle in 1 s")
        yield from entry(
            "path_departure",
            self._departure(signals, later),
            "m",
            "Position after 1 s inside (+) or outside (-) the steady circle",
        )

    def _departure(self, signals: Signals, later: float) -> float:
        """Return how far a position is inside the circle that the car was on [m]."""
        at = self.brake_at
        x, y, yaw = (signals.at(name, at) for name in ("x", "y", "yaw"))
        course = yaw + signals.at("sideslip", at)
        rate = signals.at("yaw_rate", at)
        radius = signals.at("speed", at) / rate
        centre = x - radius * math.sin(course), y + radius * math.cos(course)
        return abs(radius) - math.hypot(
            signals.at("x", later) - centre[0], signals.at("y", later) - centre[1]
        )


_JUDGED = 1.0
"""Time after the begin of braking at which the reactions are judged [s]."""
