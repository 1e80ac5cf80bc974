"""What ends the validity of a road vehicle: it rolls over, or a wheel goes through the road."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from vehicledyn.multibody.model.parts import BasePart, PartEvent, Situation
from vehicledyn.road.vehicle import RoadVehicle
from vehicledyn.road.wheel.road_wheel import RoadWheel
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

MOST_LEAN = math.radians(70.0)
"""Angle of a body's vertical axis beyond which it counts as rolled over.

It is that to the road's normal, and to the vertical as well: an edge of the road under the
chassis turns the normal, not the vehicle. The body would touch the road about there, which no
part of a model feels.
"""

_FEWEST_WHEELS = 3
"""Vehicles with fewer wheels lean."""


@dataclass(frozen=True)
class RoadLimits(BasePart):
    """Ends the run of a road vehicle where its model says nothing any more.

    Parameters
    ----------
    body
        The chassis, z axis upwards.
    wheels
        All wheels; the road under the chassis is that of the first.
    """

    body: str
    wheels: tuple[RoadWheel, ...]

    def events(self, situation: Situation) -> tuple[PartEvent, ...]:
        """Return the ends of validity."""
        lean = f"the vehicle leans by more than {math.degrees(MOST_LEAN):.0f} deg from the road"
        sunk = "the centre of a wheel has gone through the road"
        return (
            _ending("overturned", self._upright(situation), f"{lean}: it has rolled over"),
            _ending("sunk", self._lowest(situation), f"{sunk}; look for a step too long"),
        )

    def _upright(self, situation: Situation) -> Scalar:
        """Return how far the chassis is from the largest lean, in the cosine of the lean [1]."""
        kinematics = situation.kinematics
        place, axis = kinematics.position(self.body), kinematics.rotation(self.body)[:, 2]
        along, across = self.wheels[0].surface.gradient(place[0], place[1])
        length = ops.sqrt(1.0 + along * along + across * across)
        cosine = (axis[2] - along * axis[0] - across * axis[1]) / length
        return ops.maximum(cosine, axis[2]) - math.cos(MOST_LEAN)

    def _lowest(self, situation: Situation) -> Scalar:
        """Return the least height of a wheel's centre above its road [m]."""
        heights = []
        for wheel in self.wheels:
            centre = situation.kinematics.position(wheel.body)
            heights.append(centre[2] - wheel.surface.height(centre[0], centre[1]))
        lowest = heights[0]
        for height in heights[1:]:
            lowest = ops.minimum(lowest, height)
        return lowest


def _ending(name: str, expression: Scalar, advice: str) -> PartEvent:
    return PartEvent(name, expression, "falling", terminal=True, advice=advice, outcome=name)


def limited(vehicle: RoadVehicle) -> RoadVehicle:
    """Return a vehicle whose run ends where it rolls over or goes through the road."""
    wheels = tuple(part for part in vehicle.system.parts if isinstance(part, RoadWheel))
    if len(wheels) < _FEWEST_WHEELS:
        return vehicle
    body = vehicle.chassis
    return replace(vehicle, system=vehicle.system.with_parts(RoadLimits(body, body, wheels)))
