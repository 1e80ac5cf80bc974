"""Wheels that leave the ground that a road file has data of."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.road.manoeuvres.channel_recorder import Rows

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.vehicle import RoadVehicle


class RoadDataWatch:
    """Looks for the first contact point beside the data of the road."""

    def __init__(self, vehicle: RoadVehicle) -> None:
        self._surface = vehicle.surface
        self._wheels = [c.name for c in vehicle.corners] if self._surface.has_end else []
        self._left: dict[str, float] = {}

    @property
    def channels(self) -> list[str]:
        """Channels that are needed; none for ground without an end."""
        return [f"{wheel}.contact_{axis}" for wheel in self._wheels for axis in "xy"]

    def take(self, rows: Rows) -> None:
        """Take further samples."""
        import numpy as np

        for wheel in self._wheels:
            if wheel in self._left:
                continue
            x, y = (rows.channels[f"{wheel}.contact_{axis}"] for axis in "xy")
            beside = np.flatnonzero(~self._surface.covers(x, y))
            if beside.size:
                self._left[wheel] = float(rows.time[beside[0]])

    def entries(self) -> list[SummaryEntry]:
        """Return when the first wheel left the data, if one did."""
        from vehicledyn.results.store.layout import SummaryEntry

        if not self._left:
            return []
        wheel = min(self._left, key=lambda name: self._left[name])
        words = f"Time from which {wheel} is beside the data of the road file, which goes on there"
        return [SummaryEntry("road_data_left_at", self._left[wheel], "s", f"{words} as its edge")]
