"""Sine steer: the rack moves as a sine of time."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres.manoeuvre import RoadManoeuvre
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

if TYPE_CHECKING:
    from vehicledyn.road.vehicle import RoadVehicle


@register("manoeuvre", "sine_steer")
class SineSteer(RoadManoeuvre):
    """Move the rack as A sin(2 π f t) along +y."""

    amplitude: float = quantity("m", "Amplitude A of the rack")
    frequency: float = quantity("Hz", "Frequency f", gt=0)
    begin: float = quantity("s", "When the rack begins to move", default=0.0, ge=0)

    def fit(self, vehicle: RoadVehicle) -> RoadVehicle:
        """Return the vehicle with the rack driven."""
        from vehicledyn.multibody.elements.drives import TimeLaw

        p = vehicle.system.table.add_set("manoeuvre", self)

        def law(time: Scalar) -> Scalar:
            phase = 2.0 * math.pi * p.frequency * (time - p.begin)
            return ops.where(time < p.begin, 0.0, p.amplitude * ops.sin(phase))

        return super().fit(vehicle).with_parts(TimeLaw("steer", vehicle.rack, law))
