"""Key figures that every run of a road vehicle sums up."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from vehicledyn.road.manoeuvres.channel_recorder import Recording

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
    return [*pose, vehicle.rack, *body, _GAP, _OPENING, *wheels]


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
    import numpy as np

    from vehicledyn.results.metrics import peak, smallest
    from vehicledyn.results.store.layout import SummaryEntry

    time, values = recording.time, recording.channels
    entries = _rollover(recording, vehicle)

    def add_peak(name: str, channel: str, unit: str, text: str) -> None:
        extreme = peak(time, values[channel])
        entries.append(SummaryEntry(name, abs(extreme.value), unit, text))

    add_peak("largest_lateral_acceleration", _LATERAL, "m/s^2", "Largest lateral acceleration")
    add_peak("largest_roll_angle", f"{vehicle.chassis}.roll", "rad", "Largest roll angle")
    moves = ~(np.hypot(values[_SPEED], values[_LEFTWARD]) < _WALK)
    if moves.any():
        largest = abs(peak(time[moves], values[_SIDESLIP][moves]).value)
        text = "Largest side-slip angle of the body"
        entries.append(SummaryEntry("largest_sideslip_angle", largest, "rad", text))
    slips = [peak(time, values[f"{c.name}.tyre.slip_angle"]) for c in vehicle.corners]
    largest_slip = max(abs(s.value) for s in slips)
    entries.append(
        SummaryEntry("largest_slip_angle", largest_slip, "rad", "Largest slip angle of a tyre")
    )
    loads = {c.name: smallest(time, values[f"{c.name}.tyre.normal_force"]) for c in vehicle.corners}
    wheel = min(loads, key=lambda name: loads[name].value)
    entries.append(
        SummaryEntry("smallest_wheel_load", loads[wheel].value, "N", "Smallest wheel load")
    )
    entries.append(SummaryEntry("smallest_wheel_load_at", wheel, "", "Wheel with that load"))
    speed = values[_SPEED]
    entries.extend(
        [
            SummaryEntry("speed_mean", float(speed.mean()), "m/s", "Mean forward speed"),
            SummaryEntry("speed_smallest", float(speed.min()), "m/s", "Smallest forward speed"),
            SummaryEntry("speed_largest", float(speed.max()), "m/s", "Largest forward speed"),
        ]
    )
    add_peak("largest_loop_gap", _GAP, "m", "Largest position error of a loop")
    add_peak("largest_loop_speed", _OPENING, "m/s", "Largest velocity error of a loop")
    return [entry for entry in entries if _is_usable(entry)]


def _rollover(recording: Recording, vehicle: RoadVehicle) -> list[SummaryEntry]:
    """Return when the vehicle rolled over, if it did."""
    import numpy as np

    from vehicledyn.results.store.layout import SummaryEntry

    lean = np.abs([recording.channels[f"{vehicle.chassis}.{n}"] for n in ("roll", "pitch")])
    over = np.flatnonzero(lean.max(axis=0) > 0.5 * math.pi)
    if not over.size:
        return []
    text = "Time at which the vehicle rolled over; nothing after it is meaningful"
    return [SummaryEntry("rolled_over_at", float(recording.time[over[0]]), "s", text)]


def _is_usable(entry: SummaryEntry) -> bool:
    return not isinstance(entry.value, float) or math.isfinite(entry.value)
