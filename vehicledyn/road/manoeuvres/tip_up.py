"""Whether both wheels of a side rise from the road, as the rollover tests judge it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from vehicledyn.road.standards.entries import entry

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.manoeuvres.channel_recorder import Recording
    from vehicledyn.road.vehicle import RoadVehicle

LIFT = 0.0508
"""Height of both wheels of a side above the road that counts as two-wheel lift [m]."""


def lift_channels(vehicle: RoadVehicle) -> list[str]:
    """Return the deflections of the tyres, negative where a wheel is in the air."""
    return [f"{corner.name}.tyre.deflection" for corner in vehicle.corners]


def tip_up(recording: Recording, vehicle: RoadVehicle) -> Iterator[SummaryEntry]:
    """Yield the largest height of both wheels of a side, whether that is lift, and when."""
    import numpy as np

    heights = []
    for is_left in (True, False):
        side = [
            -np.asarray(recording.channels[f"{c.name}.tyre.deflection"][:])
            for c in vehicle.corners
            if c.is_left == is_left
        ]
        if side:
            heights.append(np.min(side, axis=0))
    both = np.max(heights, axis=0)
    largest = float(both.max())
    words = "Largest height of both wheels of a side above the road at once"
    yield from entry("two_wheel_height", max(largest, 0.0), "m", words)
    yield from entry("two_wheel_lift", largest >= LIFT, "1", "Whether that reaches 50.8 mm (2 in)")
    if largest >= LIFT:
        when = float(recording.time[:][int(np.argmax(both >= LIFT))])
        yield from entry("two_wheel_lift_at", when, "s", "When it does")
