"""Sine with dwell: one period of a sine that waits at its second peak, and how the car ends it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.manoeuvre import RoadManoeuvre
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SummaryEntry
    from vehicledyn.road.vehicle import RoadVehicle

_YAW_RATE = "body.yaw_rate"
_AFTER_STEER = {"first": 1.0, "second": 1.75}
"""Times after the completion of steer at which the yaw rate is judged, S5.2.1 and S5.2.2 [s]."""

_DISPLACED = 1.07
"""Time after the beginning of steer at which the displacement is judged, S5.2.3 [s]."""


@register("manoeuvre", "sine_with_dwell")
class SineWithDwell(RoadManoeuvre):
    """Move the rack as A sin(2 π f t), hold it a while at the second peak, and end the period.

    The summary has the yaw rate 1 s and 1.75 s after the end over its peak after the steering
    has reversed (not above 35 % and 20 %), and the lateral displacement of the chassis's origin
    1.07 s after the begin (from five times the angle at 0.3 g on at least 1.83 m, of cars above
    3,500 kg 1.52 m), where the run is long enough; ``stable`` is the verdict on both yaw rates.

    References
    ----------
    49 CFR 571.126 (FMVSS 126), Electronic stability control systems, S5.2 and S7.9.
    """

    amplitude: float = quantity("m", "Amplitude A of the rack")
    frequency: float = quantity("Hz", "Frequency f", default=0.7, gt=0)
    dwell: float = quantity("s", "How long the rack is held at the second peak", default=0.5, ge=0)
    begin: float = quantity("s", "When the rack begins to move", default=0.0, ge=0)

    @property
    def reversed_at(self) -> float:
        """Time at which the rack passes its middle [s]."""
        return self.begin + 0.5 / self.frequency

    @property
    def completed_at(self) -> float:
        """Time at which the rack is back in its middle for good [s]."""
        return self.begin + 1.0 / self.frequency + self.dwell

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

    def _judged(self, recording: Recording, vehicle: RoadVehicle) -> list[SummaryEntry]:
        import numpy as np

        from vehicledyn.results.store.layout import SummaryEntry
        from vehicledyn.road.manoeuvres.sine_dwell_test import MOST_FIRST, MOST_SECOND

        time = recording.time
        entries: list[SummaryEntry] = []
        peak = self._peak(recording)
        for name, later in _AFTER_STEER.items():
            asked = self.completed_at + later
            if peak > 0.0 and time[-1] >= asked:
                rate = abs(float(np.interp(asked, time, recording.channels[_YAW_RATE][:])))
                text = f"Yaw rate {later:g} s after the completion of steer over its peak"
                entries.append(SummaryEntry(f"{name}_yaw_rate_ratio", rate / peak, "1", text))
        if len(entries) == len(_AFTER_STEER):
            ratios = [float(entry.value) for entry in entries]
            falls = ratios[0] <= MOST_FIRST and ratios[1] <= MOST_SECOND
            text = "Whether the yaw rate falls to 35 % and to 20 % (S5.2.1, S5.2.2)"
            entries.append(SummaryEntry("stable", falls, "1", text))
        if time[-1] >= self.begin + _DISPLACED:
            y = recording.channels[f"{vehicle.chassis}.y"][:]
            moved = np.interp([self.begin, self.begin + _DISPLACED], time, y)
            text = f"Lateral displacement {_DISPLACED:g} s after the beginning of steer (S5.2.3)"
            entries.append(
                SummaryEntry("lateral_displacement", float(abs(moved[1] - moved[0])), "m", text)
            )
        return entries

    def _peak(self, recording: Recording) -> float:
        """Return the largest yaw rate of the direction that the reversed steering asks [rad/s]."""
        import numpy as np

        after = recording.time >= self.reversed_at
        rates = recording.channels[_YAW_RATE][:][after]
        return float(np.abs(rates).max()) if rates.size else 0.0
