"""Wheels that leave the ground that a road file has data of, or roll where heights are missing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.road.manoeuvres.channel_recorder import ChannelRows

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.vehicle import RoadVehicle


class RoadDataMonitor:
    """Looks for the first contact points beside the data of the road and at missing heights."""

    def __init__(self, vehicle: RoadVehicle) -> None:
        self._surface = vehicle.surface
        self._wheels = [c.name for c in vehicle.corners] if self._surface.has_end else []
        self._left: dict[str, float] = {}
        self._gap: dict[str, tuple[float, float, float]] = {}

    @property
    def channels(self) -> list[str]:
        """Channels that are needed; none for ground without an end."""
        return [f"{wheel}.contact_{axis}" for wheel in self._wheels for axis in "xy"]

    def take(self, rows: ChannelRows) -> None:
        """Take further samples."""
        import numpy as np

        for wheel in self._wheels:
            x, y = (rows.channels[f"{wheel}.contact_{axis}"] for axis in "xy")
            beside = np.flatnonzero(~self._surface.covers(x, y))
            if beside.size:
                self._left.setdefault(wheel, float(rows.time[beside[0]]))
            lacking = np.flatnonzero(self._surface.lacks(x, y))
            if lacking.size:
                at = lacking[0]
                self._gap.setdefault(wheel, (float(rows.time[at]), float(x[at]), float(y[at])))

    def entries(self) -> list[SummaryEntry]:
        """Return when the first wheel left the data, and when one rolled on missing heights."""
        from vehicledyn.results.store.layout import SummaryEntry

        entries = []
        if self._left:
            wheel = min(self._left, key=lambda name: self._left[name])
            words = f"Time from which {wheel} is beside the data of the road file, which goes on"
            text = f"{words} there as its edge"
            entries.append(SummaryEntry("road_data_left_at", self._left[wheel], "s", text))
        if self._gap:
            wheel = min(self._gap, key=lambda name: self._gap[name][0])
            time, x, y = self._gap[wheel]
            u, v = (float(place) for place in self._surface.line_place(x, y)[:2])
            text = (
                f"Time from which {wheel} rolls where heights of the road file are missing and "
                f"filled: u = {u:.6g} m, v = {v:.6g} m"
            )
            entries.append(SummaryEntry("road_data_missing_at", time, "s", text))
        return entries
