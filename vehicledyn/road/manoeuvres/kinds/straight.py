"""Straight on: the rack is held; for bumps, standing still and coasting."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres.manoeuvre import RoadManoeuvre

if TYPE_CHECKING:
    from vehicledyn.road.vehicle import RoadVehicle


@register("manoeuvre", "straight")
class Straight(RoadManoeuvre):
    """Hold the rack in the middle."""

    def fit(self, vehicle: RoadVehicle) -> RoadVehicle:
        """Return the vehicle with the rack held."""
        from vehicledyn.multibody.elements.drives import TimeLaw

        return super().fit(vehicle).with_parts(TimeLaw("steer", vehicle.rack, lambda _: 0.0))
