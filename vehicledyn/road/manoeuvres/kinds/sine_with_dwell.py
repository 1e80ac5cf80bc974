"""Sine with dwell: one period of a sine that waits at its second peak, and how the car ends it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.manoeuvre import RoadManoeuvre
from vehicledyn.road.standards.entries import entry
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.vehicle import RoadVehicle

_YAW_RATE = "body.yaw_rate"


@register("manoeuvre", "sine_with_dwell")
class SineWithDwell(RoadManoeuvre):
    """Move the rack as A sin(2 π f t), hold it a while at the second peak, and end the period.

    The summary has the yaw rate 1 s and 1.75 s after the end over its first peak after the
    steering has reversed (not above 35 % and 20 %), and the lateral displacement of the chassis's
    origin 1.07 s after the steering wheel passes 5 degrees (from five times the angle at 0.3 g on
    at least 1.83 m, of cars above 3,500 kg 1.52 m), where the run is long enough; ``stable`` is
    the verdict on both yaw rates. The standards' test coasts, as runs without speed control do,
    and is driven to both sides.

    References
    ----------
    49 CFR 571.126 (FMVSS 126), Electronic stability control systems, S5.2 and S7.9.
    """

    amplitude: float = quantity("m", "Amplitude A of the rack")
    frequency: float = quantity("Hz", "Frequency f", default=0.7, gt=0)
    dwell: float = quantity("s", "How long the rack is held at the second peak", default=0.5, ge=0)
    begin: float = quantity("s", "When the rack begins to move", default=0.0, ge=0)

    def fit(self, vehicle: RoadVehicle) -> RoadVehicle:
        """Return the vehicle with the rack driven."""
        from vehicledyn.multibody.elements.drives import TimeLaw

        p = vehicle.system.table.add_set("manoeuvre", self)

        def law(time: Scalar) -> Scalar:
            since = time - p.begin
            second_peak = 0.75 / p.frequency
            moved = ops.minimum(since, second_peak) + ops.maximum(
                since - second_peak - p.dwell, 0.0
            )
            turned = ops.minimum(ops.maximum(p.frequency * moved, 0.0), 1.0)
            return p.amplitude * ops.sin(2.0 * math.pi * turned)

        return super().fit(vehicle).with_parts(TimeLaw("steer", vehicle.rack, law))

    def channels(self, vehicle: RoadVehicle) -> list[str]:
        """Return the channels of the key figures."""
        return [*super().channels(vehicle), _YAW_RATE]

    def summarise(self, recording: Recording, vehicle: RoadVehicle) -> list[SummaryEntry]:
        """Return the ratios of yaw rates, the displacement, and the general key figures."""
        return [*self._judged(recording, vehicle), *super().summarise(recording, vehicle)]

    def _judged(self, recording: Recording, vehicle: RoadVehicle) -> Iterator[SummaryEntry]:
        from vehicledyn.road.standards.sine_dwell import (
            DISPLACED_AFTER,
            FIRST_AFTER,
            SECOND_AFTER,
            Dwelling,
            judged,
        )

        ratio = vehicle.worth(vehicle.steering_ratio)
        wheel = self.amplitude * vehicle.worth(vehicle.steering_gain) * ratio
        given = Dwelling(self.begin, self.frequency, self.dwell, wheel if ratio > 1.0 else None)
        rate, y = (recording.channels[name][:] for name in (_YAW_RATE, f"{vehicle.chassis}.y"))
        verdict = judged(recording.time[:], rate, y, given)
        for name, after in (("first", FIRST_AFTER), ("second", SECOND_AFTER)):
            words = f"Yaw rate {after:g} s after the completion of steer over its peak"
            yield from entry(
                f"{name}_yaw_rate_ratio", getattr(verdict, f"{name}_ratio"), "1", words
            )
        if not math.isnan(verdict.second_ratio):
            words = "Whether the yaw rate falls to 35 % and to 20 % (S5.2.1, S5.2.2)"
            yield from entry("stable", verdict.is_stable, "1", words)
        words = f"Lateral displacement {DISPLACED_AFTER:g} s after the beginning of steer (S5.2.3)"
        yield from entry("lateral_displacement", verdict.displacement, "m", words)
        if self.speed_control is not None:
            words = "Departures from the conditions of FMVSS 126 and UN R140"
            remark = "the speed is held, where the test coasts: leave speed_control out"
            yield from entry("test_conditions", remark, "", words)
