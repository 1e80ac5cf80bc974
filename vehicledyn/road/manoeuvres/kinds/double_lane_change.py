"""Double lane change of ISO 3888-1 between cones, at a held speed."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres.lane_change_test import LaneChangeTest
from vehicledyn.road.standards.evasion import Lane, double_lane_change

if TYPE_CHECKING:
    from vehicledyn.road.vehicle import RoadVehicle


@register("manoeuvre", "double_lane_change")
class DoubleLaneChange(LaneChangeTest):
    """Change to the left lane and back between cones; the lanes follow from the vehicle's width.

    The summary says whether the swept corners keep all lanes, and the clearance of each section.
    The customary entry speed is 80 km/h with a steady throttle. The standard leaves the path to the
    driver: this one cuts corners by 3 m and keeps to the inside of the third section.

    References
    ----------
    ISO 3888-1, Passenger cars - Test track for a severe lane-change manoeuvre - Double lane-change.
    """

    standard: ClassVar[str] = "ISO 3888-1"
    corner: ClassVar[float] = 3.0
    inner: ClassVar[float] = 0.3

    def lanes(self, vehicle: RoadVehicle) -> tuple[Lane, Lane, Lane]:
        """Return the three lanes."""
        sides = [corner[1] for corner in vehicle.outline]
        return double_lane_change(max(sides) - min(sides), self.begin)
