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
    and the heading at the end. ``split_braking`` is the test on a road of two frictions.

    References
    ----------
    ISO 21994, Passenger cars - Stopping distance at straight-line braking with ABS. Mean fully
    developed deceleration: UN R13-H, annex 3.
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
        from vehicledyn.road.standards.braking import deceleration_figures

        braked = signals.between(self.brake_at, float(signals.time[-1]))
        if len(braked.time) < 2:
            return
        yield from deceleration_figures(braked)
        turned = float(braked.yaw[-1] - braked.yaw[0])
        yield from entry("heading_change", turned, "rad", "Heading at the end against the begin")
        aside = float(abs(braked.y - braked.y[0]).max())
        yield from entry("lateral_deviation", aside, "m", "Largest lateral deviation while braking")
