"""Tyres that a run takes out of the ranges of their property files."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from vehicledyn.road.manoeuvres.channel_recorder import ChannelRows
from vehicledyn.road.tyre_files.tyre_file import ValidRange
from vehicledyn.road.tyres.file_tyre import FileTyre

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.vehicle import RoadVehicle

_CHANNELS = {
    "load": ("normal_force", "Wheel load"),
    "longitudinal_slip": ("longitudinal_slip", "Longitudinal slip"),
    "slip_angle": ("slip_angle", "Slip angle"),
    "camber": ("camber", "Camber"),
}


class _Watched(NamedTuple):
    """A channel of a wheel and the range it should keep."""

    wheel: str
    quantity: str
    channel: str
    range: ValidRange


class _Found(NamedTuple):
    """The farthest value outside of a range, and the time when the range was first left."""

    value: float
    excess: float
    time: float


class RangeMonitor:
    """Looks for values outside the ranges; small loads, as of lifted wheels, do not count."""

    def __init__(self, vehicle: RoadVehicle) -> None:
        self._watched = tuple(_watched(vehicle))
        self._found: dict[_Watched, _Found] = {}

    @property
    def channels(self) -> list[str]:
        """Channels that are needed; none for tyres without files."""
        return [item.channel for item in self._watched]

    def take(self, rows: ChannelRows) -> None:
        """Take further samples."""
        import numpy as np

        for item in self._watched:
            values = rows.channels[item.channel]
            low, high = item.range.lowest, item.range.highest
            below = np.zeros_like(values) if item.quantity == "load" else low - values
            excess = np.maximum(below, values - high)
            if not np.any(excess > 0.0):
                continue
            worst, first = int(np.argmax(excess)), int(np.argmax(excess > 0.0))
            known = self._found.get(item)
            found = _Found(float(values[worst]), float(excess[worst]), float(rows.time[first]))
            if known is not None:
                farther = found if found.excess > known.excess else known
                found = farther._replace(time=known.time)
            self._found[item] = found

    def entries(self) -> list[SummaryEntry]:
        """Return a line for each range that was left."""
        from vehicledyn.results.store.layout import SummaryEntry

        lines = []
        for item, found in self._found.items():
            text = _CHANNELS[item.quantity][1]
            low, high, unit = item.range.lowest, item.range.highest, item.range.unit
            words = f"{text} of {item.wheel} outside {low:g} to {high:g} {unit} of its tyre file"
            name = f"{item.wheel}_{item.quantity}_outside_range"
            words += f", first at {found.time:.4g} s"
            lines.append(SummaryEntry(name, found.value, unit, words))
        return lines


def _watched(vehicle: RoadVehicle) -> list[_Watched]:
    from vehicledyn.road.wheel.road_wheel import RoadWheel

    wheels = [part for part in vehicle.system.parts if isinstance(part, RoadWheel)]
    return [
        _Watched(wheel.name, quantity, f"{wheel.name}.tyre.{channel}", wheel.tyre.ranges[quantity])
        for wheel in wheels
        if isinstance(wheel.tyre, FileTyre)
        for quantity, (channel, _) in _CHANNELS.items()
        if quantity in wheel.tyre.ranges
    ]
