"""Stanley driver: heading of the path, and an angle that grows with the front axle's offset.

δ = ψ_path - ψ + atan(k e / v), with the path's offset e to the left of the front axle and the speed
v: rolling without slip, e falls as ė = -k e / √(1 + (k e/v)²).

References
----------
Hoffmann, Tomlin, Montemerlo, Thrun (2007), Autonomous Automobile Trajectory Tracking for Off-Road
Driving, American Control Conference 2007.
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


@register("driver", "stanley")
class Stanley(SteeringDriver):
    """Driver who turns the wheels along the path, and towards it by the front axle's offset."""

    gain: float = quantity("1/s", "Rate k at which a small offset falls", gt=0)

    def part(self, vehicle: RoadVehicle, path: Callable[[Scalar], Scalar]) -> Part:
        """Return the driver at the wheel of a vehicle."""
        from vehicledyn.road.drivers.steering_hands import SteeringHands, slope_of, speed_of
        from vehicledyn.symbolic import ops

        settings = vehicle.system.table.add_set("driver", self)

        def wanted(situation: Situation) -> Scalar:
            kinematics, chassis = situation.kinematics, vehicle.chassis
            place, axis = kinematics.position(chassis), kinematics.rotation(chassis)[:, 0]
            front = [place[k] + vehicle.front_distance * axis[k] for k in (0, 1)]
            course = ops.atan(slope_of(path, front[0]))
            heading = ops.atan2(axis[1], axis[0])
            offset = (path(front[0]) - front[1]) * ops.cos(course)
            speed = speed_of(situation, chassis)
            return course - heading + ops.atan(settings.gain * offset / speed)

        return SteeringHands("driver", vehicle, settings, path, wanted)
