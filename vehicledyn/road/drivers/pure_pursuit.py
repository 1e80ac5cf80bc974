"""Pure pursuit: the arc from the rear axle, along its heading, to a point of the path ahead.

δ = atan(2 l sin η / d), with the distance d and the angle η to the heading of the point, seen from
the rear axle: on a circle of radius R that is atan(l/R) whatever the distance.

References
----------
Coulter (1992), Implementation of the Pure Pursuit Path Tracking Algorithm, CMU-RI-TR-92-01.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.drivers.steering_driver import SteeringDriver

if TYPE_CHECKING:
    from vehicledyn.multibody.model.parts import Part, Situation
    from vehicledyn.road.vehicle import RoadVehicle
    from vehicledyn.symbolic.ops import Scalar


@register("driver", "pure_pursuit")
class PurePursuit(SteeringDriver):
    """Driver who steers on an arc to a point of the path ahead of the rear axle."""

    distance: float = quantity("m", "Way ahead along the heading to the point's position", gt=0)

    def part(self, vehicle: RoadVehicle, path: Callable[[Scalar], Scalar]) -> Part:
        """Return the driver at the wheel of a vehicle."""
        from vehicledyn.road.drivers.steering_hands import SteeringHands
        from vehicledyn.symbolic import ops

        settings = vehicle.system.table.add_set("driver", self)
        behind = vehicle.front_distance - vehicle.wheelbase

        def wanted(situation: Situation) -> Scalar:
            kinematics, chassis = situation.kinematics, vehicle.chassis
            place, axis = kinematics.position(chassis), kinematics.rotation(chassis)[:, 0]
            rear = [place[k] + behind * axis[k] for k in (0, 1)]
            x = rear[0] + settings.distance * axis[0]
            ahead = (x - rear[0], path(x) - rear[1])
            level = ops.smooth_norm(axis[0], axis[1], 0.0)
            across = (axis[0] * ahead[1] - axis[1] * ahead[0]) / level
            squared = ahead[0] * ahead[0] + ahead[1] * ahead[1]
            return ops.atan(2.0 * vehicle.wheelbase * across / squared)

        return SteeringHands("driver", vehicle, settings, path, wanted)
