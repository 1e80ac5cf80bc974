"""Obstacle avoidance of ISO 3888-2 between cones, with the throttle released at the entry."""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.manoeuvres.lane_change_test import LaneChangeTest
from vehicledyn.road.manoeuvres.time_table import TimeTable
from vehicledyn.road.standards.evasion import Lane, obstacle_avoidance

if TYPE_CHECKING:
    from vehicledyn.road.vehicle import RoadVehicle


@register("manoeuvre", "obstacle_avoidance")
class ObstacleAvoidance(LaneChangeTest):
    """Swerve round an obstacle and back; the lanes follow from the vehicle's width.

    The throttle is released 2 m into the first section, at the time that the scenario's entry speed
    takes to get there: give it as ``release_at``. The summary says whether the swept corners keep
    all lanes, and the clearance of each section. The standard leaves the path to the driver: this
    one cuts corners by 3 m and keeps to the inside of the third section, as its 13.5 m and 12.5 m
    between the lanes ask for.

    References
    ----------
    ISO 3888-2, Passenger cars - Test track for a severe lane-change manoeuvre - Obstacle avoidance.
    """

    standard: ClassVar[str] = "ISO 3888-2"
    corner: ClassVar[float] = 3.0
    inner: ClassVar[float] = 0.3

    release_at: float = quantity("s", "When the throttle is released", ge=0)

    def throttle(self) -> TimeTable:
        """Return the throttle, released after the entry."""
        return TimeTable((self.release_at, self.release_at + 0.1), (1.0, 0.0))

    def lanes(self, vehicle: RoadVehicle) -> tuple[Lane, Lane, Lane]:
        """Return the three lanes."""
        sides = [corner[1] for corner in vehicle.outline]
        return obstacle_avoidance(max(sides) - min(sides), self.begin)
