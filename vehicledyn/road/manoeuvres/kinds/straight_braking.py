"""Straight braking: brakes are applied on a straight road until the car stops (ISO 21994)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres import figures
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.driving_test import DrivingTest
from vehicledyn.road.manoeuvres.time_table import TimeTable
from vehicledyn.road.standards.entries import entry

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.standards.signals import Signals
    from vehicledyn.road.vehicle import RoadVehicle


@register("manoeuvre", "straight_braking")
class StraightBraking(DrivingTest):
    """Release the throttle and apply the brakes, the steering wheel held straight.

    The summary has the stopping distance from the begin of braking, where the run is long enough;
    the mean fully developed deceleration, of the way between 80 % and 10 % of the initial speed;
    and the heading at the end. On a road of two frictions the heading shows the yaw that the
    different brake forces of the sides bring about (ISO 14512).

    References
    ----------
    ISO 21994, Passenger cars - Stopping distance at straight-line braking with ABS. ISO 14512,
    Passenger cars - Straight-ahead braking on surfaces with split coefficient of friction. Mean
    fully developed deceleration: UN R13-H, annex 3.
    """

    torque: float = quantity("N*m", "Brake torque of all wheels together", gt=0)
    brake_at: float = quantity("s", "When the brakes begin", default=0.5, ge=0)
    build_up: float = quantity("s", "How long the torque takes to grow", default=0.2, gt=0)

    def throttle(self) -> TimeTable:
        """Return the throttle, released when the brakes begin."""
        return TimeTable((self.brake_at, self.brake_at + 0.1), (1.0, 0.0))

    def brake_torque(self) -> TimeTable:
        """Return the brake torque, which grows and stays."""
        return TimeTable((self.brake_at, self.brake_at + self.build_up), (0.0, self.torque))

    def plots(self, vehicle: RoadVehicle) -> list[dict[str, Any]]:
        """Return the standard figures after speed, acceleration, slip and pitch."""
        return [figures.along("Straight braking", vehicle), *figures.standard(vehicle)]

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield distances, deceleration and heading."""
        import numpy as np

        braked = signals.between(self.brake_at, float(signals.time[-1]))
        if len(braked.time) < 2:
            return
        way = np.concatenate([[0.0], np.cumsum(np.diff(braked.time) * 0.5 * (
            braked.speed[1:] + braked.speed[:-1]))])  # fmt: skip
        first = float(braked.speed[0])
        yield from entry("initial_speed", first, "m/s", "Speed at which the brakes begin")
        falling = -braked.speed  # rises, as interpolation needs it
        if braked.speed.min() <= _STOPPED:
            stop = float(np.interp(-_STOPPED, falling, way))
            yield from entry(
                "stopping_distance", stop, "m", "Way from the begin of braking to rest"
            )
        if first > _STOPPED and braked.speed.min() <= 0.1 * first:
            ways = np.interp([-0.8 * first, -0.1 * first], falling, way)
            mean = (0.8**2 - 0.1**2) * first**2 / (2.0 * (ways[1] - ways[0]))
            words = "Mean fully developed deceleration, between 80 % and 10 % of the speed"
            yield from entry("mean_deceleration", float(mean), "m/s^2", words)
        turned = float(braked.yaw[-1] - braked.yaw[0])
        yield from entry("heading_change", turned, "rad", "Heading at the end against the begin")
        aside = float(abs(braked.y - braked.y[0]).max())
        yield from entry("lateral_deviation", aside, "m", "Largest lateral deviation while braking")


_STOPPED = 0.1
"""Speed that counts as standing [m/s]."""
