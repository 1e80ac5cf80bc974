"""Acceleration: a drive torque on a straight road, with the times to some speeds."""

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


@register("manoeuvre", "acceleration")
class Acceleration(DrivingTest):
    """Apply a drive torque on a straight road, the steering wheel held.

    The torque acts on all wheels together, or on the vehicle's own driveline. The summary has the
    times and ways to 50, 100 and 150 km/h from the begin, and the largest acceleration.
    """

    torque: float = quantity("N*m", "Drive torque", gt=0)
    begin: float = quantity("s", "When the torque begins", default=0.5, ge=0)
    build_up: float = quantity("s", "How long the torque takes to grow", default=0.3, gt=0)

    def drive_torque(self) -> TimeTable:
        """Return the torque, which grows and stays."""
        return TimeTable((self.begin, self.begin + self.build_up), (0.0, self.torque))

    def plots(self, vehicle: RoadVehicle) -> list[dict[str, Any]]:
        """Return the standard figures after speed, acceleration, slip and pitch."""
        return [figures.along("Acceleration", vehicle), *figures.standard(vehicle)]

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield times and ways to some speeds."""
        from vehicledyn.road.standards.step_response import first_crossing

        driven = signals.between(self.begin, float(signals.time[-1]))
        if len(driven.time) < 2:
            return
        largest = float(driven.longitudinal_acceleration.max())
        words = "Largest longitudinal acceleration"
        yield from entry("largest_longitudinal_acceleration", largest, "m/s^2", words)
        for speed in _SPEEDS:
            wanted = speed / 3.6
            if driven.speed[0] >= wanted or driven.speed.max() < wanted:
                continue
            when = first_crossing(driven.time, driven.speed, wanted)
            yield from entry(
                f"time_to_{speed}_km_h",
                when - self.begin,
                "s",
                f"Time from the begin to {speed} km/h",
            )
            yield from entry(
                f"way_to_{speed}_km_h",
                driven.at("x", when) - float(driven.x[0]),
                "m",
                f"Way from the begin to {speed} km/h",
            )


_SPEEDS = (50, 100, 150)
