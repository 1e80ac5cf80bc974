"""Ramp steer: the rack moves at a constant rate for a while and is then held."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres.manoeuvre import RoadManoeuvre
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

if TYPE_CHECKING:
    from vehicledyn.road.vehicle import RoadVehicle


@register("manoeuvre", "ramp_steer")
class RampSteer(RoadManoeuvre):
    """Move the rack along +y (-y if negative) at a rate, then hold it."""

    rate: float = quantity("m/s", "Speed of the rack along +y")
    ramp_time: float = quantity("s", "How long the rack moves", gt=0)
    begin: float = quantity("s", "When the rack begins to move", default=0.0, ge=0)

    def fit(self, vehicle: RoadVehicle) -> RoadVehicle:
        """Return the vehicle with the rack driven."""
        from vehicledyn.multibody.elements.drives import TimeLaw

        p = vehicle.system.table.add_set("manoeuvre", self)

        def law(time: Scalar) -> Scalar:
            moving = p.rate * (time - p.begin)
            held = ops.where(time < p.begin + p.ramp_time, moving, p.rate * p.ramp_time)
            return ops.where(time < p.begin, 0.0, held)

        return super().fit(vehicle).with_parts(TimeLaw("steer", vehicle.rack, law))
