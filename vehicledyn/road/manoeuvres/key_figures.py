"""Key figures that every run of a road vehicle sums up."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from vehicledyn.road.manoeuvres.channel_recorder import ChannelRows, Recording
from vehicledyn.road.manoeuvres.road_data import RoadDataMonitor
from vehicledyn.road.manoeuvres.tyre_ranges import RangeMonitor

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SceneItem, SummaryEntry
    from vehicledyn.road.vehicle import RoadVehicle

_SPEED = "body.forward_speed"
_LEFTWARD = "body.lateral_speed"
_LATERAL = "accelerometer.lateral"
_SIDESLIP = "body.sideslip_angle"
_GAP = "constraints.position_error"
_OPENING = "constraints.velocity_error"
_WALK = 1.0
"""Speed from which the largest side-slip angle counts; a car that rocks on its springs at
standstill has any [m/s]."""


def channels(vehicle: RoadVehicle) -> list[str]:
    """Return the channels the key figures need."""
    pose = [f"{vehicle.chassis}.{name}" for name in ("x", "y", "yaw", "roll", "pitch")]
    wheels = [
        f"{c.name}.tyre.{name}" for c in vehicle.corners for name in ("normal_force", "slip_angle")
    ]
    body = [_SPEED, _LEFTWARD, _LATERAL, _SIDESLIP]
    needed = [*pose, vehicle.rack, *body, _GAP, _OPENING, *wheels]
    return list(
        dict.fromkeys(
            [*needed, *RangeMonitor(vehicle).channels, *RoadDataMonitor(vehicle).channels]
        )
    )


def outline_scene(vehicle: RoadVehicle) -> dict[str, SceneItem]:
    """Return the body's outline as a thing to draw."""
    from vehicledyn.results.store.layout import SceneItem

    return {
        "outline": SceneItem(
            vehicle.outline, "m", "Body seen from above, in chassis axes", {"frame": "chassis"}
        )
    }


def summarise(recording: Recording, vehicle: RoadVehicle) -> list[SummaryEntry]:
    """Return peaks of acceleration, angles and slip, smallest load, speed and loop errors."""
    from vehicledyn.results.store.layout import SummaryEntry

    found, ranges, ground = _Extremes(vehicle), RangeMonitor(vehicle), RoadDataMonitor(vehicle)
    for block in recording.blocks(_read(vehicle)):
        found.take(block)
        ranges.take(block)
        ground.take(block)
    peaks = {name: abs(extreme.value) for name, extreme in found.peaks.items()}
    wheel = min(found.loads, key=lambda name: found.loads[name].value)
    load = found.loads[wheel].value
    slip = max(peaks[f"{c.name}.tyre.slip_angle"] for c in vehicle.corners)
    entry = SummaryEntry
    entries = [
        *found.rollover(),
        entry("largest_lateral_acceleration", peaks[_LATERAL], "m/s^2",
              "Largest lateral acceleration"),
        entry("largest_roll_angle", peaks[f"{vehicle.chassis}.roll"], "rad", "Largest roll angle"),
        entry("largest_sideslip_angle", peaks[_SIDESLIP], "rad",
              "Largest side-slip angle of the body"),
        entry("largest_slip_angle", slip, "rad", "Largest slip angle of a tyre"),
        entry("smallest_wheel_load", load, "N", "Smallest wheel load"),
        entry("smallest_wheel_load_at", wheel, "", "Wheel with that load"),
        entry("speed_mean", found.way / max(recording.count, 1), "m/s", "Mean forward speed"),
        entry("speed_smallest", found.slowest.value, "m/s", "Smallest forward speed"),
        entry("speed_largest", found.fastest.value, "m/s", "Largest forward speed"),
        entry("largest_loop_gap", peaks[_GAP], "m", "Largest position error of a loop"),
        entry("largest_loop_speed", peaks[_OPENING], "m/s", "Largest velocity error of a loop"),
        *ranges.entries(),
        *ground.entries(),
    ]  # fmt: skip
    return [entry for entry in entries if _is_usable(entry)]


def _read(vehicle: RoadVehicle) -> list[str]:
    """Return the channels that are read for this summary."""
    unread = {f"{vehicle.chassis}.{name}" for name in ("x", "y", "yaw")} | {vehicle.rack}
    return [name for name in channels(vehicle) if name not in unread]


class _Extremes:
    """Extremes of a road vehicle's channels, block by block."""

    def __init__(self, vehicle: RoadVehicle) -> None:
        from vehicledyn.results.metrics import RunningExtreme, largest, peak, smallest

        slips = [f"{c.name}.tyre.slip_angle" for c in vehicle.corners]
        whole = [_LATERAL, f"{vehicle.chassis}.roll", _SIDESLIP, *slips, _GAP, _OPENING]
        self.peaks = {name: RunningExtreme(peak) for name in whole}
        self.loads = {c.name: RunningExtreme(smallest) for c in vehicle.corners}
        self.slowest, self.fastest = RunningExtreme(smallest), RunningExtreme(largest)
        self.way = 0.0  # sum of the speeds of all samples
        self._lean = [f"{vehicle.chassis}.{name}" for name in ("roll", "pitch")]
        self._rolled_at: float | None = None

    def take(self, rows: ChannelRows) -> None:
        """Take further samples."""
        import numpy as np

        time, values = rows
        speed = values[_SPEED]
        for name, extreme in self.peaks.items():
            if name != _SIDESLIP:
                extreme.take(time, values[name])
        moves = ~(np.hypot(speed, values[_LEFTWARD]) < _WALK)
        self.peaks[_SIDESLIP].take(time[moves], values[_SIDESLIP][moves])
        for name, load in self.loads.items():
            load.take(time, values[f"{name}.tyre.normal_force"])
        self.slowest.take(time, speed)
        self.fastest.take(time, speed)
        self.way += float(speed.sum())
        over = np.flatnonzero(np.abs([values[n] for n in self._lean]).max(axis=0) > 0.5 * math.pi)
        if self._rolled_at is None and over.size:
            self._rolled_at = float(time[over[0]])

    def rollover(self) -> list[SummaryEntry]:
        """Return when the vehicle rolled over, if it did."""
        from vehicledyn.results.store.layout import SummaryEntry

        if self._rolled_at is None:
            return []
        text = "Time at which the vehicle rolled over; nothing after it is meaningful"
        return [SummaryEntry("rolled_over_at", self._rolled_at, "s", text)]


def _is_usable(entry: SummaryEntry) -> bool:
    return not isinstance(entry.value, float) or math.isfinite(entry.value)
