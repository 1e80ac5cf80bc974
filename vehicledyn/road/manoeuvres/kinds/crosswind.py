"""Side wind: a gust pushes the car off its course while the steering wheel is held (ISO 12021)."""

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


@register("manoeuvre", "crosswind")
class Crosswind(DrivingTest):
    """Hold the steering wheel while a lateral force acts for a while ahead of the origin.

    The force stands for a wind generator's: the car's own coefficients and its place of attack
    make it, which the user gives. The summary has the lateral displacement 2 s after the gust
    begins, and the largest yaw rate and lateral acceleration.

    References
    ----------
    ISO 12021, Road vehicles - Sensitivity to lateral wind - Open-loop test method using wind
    generator input.
    """

    force: float = quantity("N", "Lateral force of the gust, to the left")
    ahead: float = quantity("m", "Its distance ahead of the chassis's origin")
    begin: float = quantity("s", "When the gust begins", default=1.0, ge=0)
    rise: float = quantity("s", "How long it takes to grow and to fall", default=0.1, gt=0)
    gust: float = quantity("s", "How long it lasts at its full force", default=1.0, gt=0)

    def side_wind(self) -> TimeTable:
        """Return the gust."""
        full, end = self.begin + self.rise, self.begin + self.rise + self.gust
        times = (self.begin, full, end, end + self.rise)
        return TimeTable(times, (0.0, self.force, self.force, 0.0))

    @property
    def wind_ahead(self) -> float:
        """Distance of the force ahead of the chassis's origin [m]."""
        return self.ahead

    def plots(self, vehicle: RoadVehicle) -> list[dict[str, Any]]:
        """Return the standard figures with the answers over one another."""
        return [figures.answers("Side wind"), *figures.standard(vehicle)]

    def quantities(
        self, signals: Signals, recording: Recording, vehicle: RoadVehicle
    ) -> Iterator[SummaryEntry]:
        """Yield displacement and peaks."""
        later = signals.between(self.begin, float(signals.time[-1]))
        for name, unit, text in _PEAKS:
            yield from entry(f"wind_{name}", float(abs(getattr(later, name)).max()), unit, text)
        if signals.time[-1] >= self.begin + _JUDGED:
            moved = signals.at("y", self.begin + _JUDGED) - signals.at("y", self.begin)
            words = f"Lateral displacement {_JUDGED:g} s after the gust begins"
            yield from entry("lateral_displacement", moved, "m", words)


_JUDGED = 2.0
_PEAKS = (
    ("yaw_rate", "rad/s", "Largest yaw rate in the wind"),
    ("lateral_acceleration", "m/s^2", "Largest lateral acceleration in the wind"),
)
