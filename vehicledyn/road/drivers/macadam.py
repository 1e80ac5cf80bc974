"""MacAdam's optimal preview driver: the steady angle whose path is nearest to the wanted one.

The driver predicts the car as a single-track model ẋ = A x + B δ, x = (y, v_y, r, ψ), at a speed
he knows. With a constant angle it would be at y(τ) = C e^{Aτ} x + g(τ) δ, g = C ∫ e^{As} ds B; the
angle of least squared distance to the path at N times within the preview time is

δ = Σ g_i (f_i - C e^{Aτ_i} x) / Σ g_i²,

f the path's y ahead. The sums stand for the integrals over the preview time.

References
----------
MacAdam (1980), An optimal preview control for linear systems, J. Dyn. Sys. Meas. Control 102(3),
188-190. MacAdam (1981), Application of an optimal preview control for simulation of closed-loop
automobile driving, IEEE Trans. Syst. Man Cybern. 11(6), 393-399.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from pydantic import Field

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.drivers.steering_driver import SteeringDriver

if TYPE_CHECKING:
    from vehicledyn.multibody.model.parts import Part, Situation
    from vehicledyn.road.vehicle import RoadVehicle
    from vehicledyn.symbolic.ops import Scalar


@register("driver", "macadam")
class MacAdam(SteeringDriver):
    """Driver who knows the car as a single-track model, and looks at several points ahead."""

    preview_time: float = quantity("s", "How far ahead the driver looks", gt=0)
    points: int = Field(default=10, description="Number of points N ahead", ge=1, le=100)
    speed: float = quantity("m/s", "Speed that the prediction is for", gt=0)
    mass: float = quantity("kg", "Mass of the car", gt=0)
    yaw_inertia: float = quantity("kg*m^2", "Moment of inertia about the vertical", gt=0)
    front_distance: float = quantity("m", "Front axle ahead of the centre of mass", gt=0)
    rear_distance: float = quantity("m", "Rear axle behind the centre of mass", gt=0)
    front_stiffness: float = quantity("N/rad", "Cornering stiffness of the front axle", gt=0)
    rear_stiffness: float = quantity("N/rad", "Cornering stiffness of the rear axle", gt=0)

    def numbers(self) -> dict[str, float]:
        """Return the parameters of the driver by name: gains, and what a free motion comes to."""
        from vehicledyn.road.drivers.optimal_preview import prediction

        found: dict[str, float] = {}
        known = prediction(self)
        for k, (time, gain, free) in enumerate(
            zip(known.times, known.gains, known.free, strict=True)
        ):
            found[f"driver.time_{k}"], found[f"driver.gain_{k}"] = float(time), float(gain)
            for name, value in zip(_STATE, free, strict=True):
                found[f"driver.{name}_{k}"] = float(value)
        return found

    def part(self, vehicle: RoadVehicle, path: Callable[[Scalar], Scalar]) -> Part:
        """Return the driver at the wheel of a vehicle."""
        from vehicledyn.road.drivers.steering_hands import SteeringHands
        from vehicledyn.symbolic import ops

        table = vehicle.system.table
        p = {name: table.add(name, v, *_words(name)) for name, v in self.numbers().items()}

        def wanted(situation: Situation) -> Scalar:
            kinematics, chassis = situation.kinematics, vehicle.chassis
            place, velocity = kinematics.position(chassis), kinematics.velocity(chassis)
            axis = kinematics.rotation(chassis)[:, 0]
            heading = ops.atan2(axis[1], axis[0])
            aside = ops.cos(heading) * velocity[1] - ops.sin(heading) * velocity[0]
            spin = kinematics.rotation(chassis) @ kinematics.angular_velocity(chassis)
            state = (place[1], aside, spin[2], heading)
            angle: Scalar = 0.0
            for k in range(self.points):
                ahead = path(place[0] + p[f"driver.time_{k}"] * velocity[0])
                reached = sum(
                    p[f"driver.{name}_{k}"] * value
                    for name, value in zip(_STATE, state, strict=True)
                )
                angle = angle + p[f"driver.gain_{k}"] * (ahead - reached)
            return angle

        return SteeringHands("driver", vehicle, self, path, wanted)


_STATE = ("by_place", "by_velocity", "by_yaw_rate", "by_heading")
_UNITS = {
    "time": ("s", "Time ahead of a point"),
    "gain": ("rad/m", "Steering angle by the distance at a point"),
    "by_place": ("1", "Free motion to a point by the place"),
    "by_velocity": ("s", "Free motion to a point by the lateral velocity"),
    "by_yaw_rate": ("m*s/rad", "Free motion to a point by the yaw rate"),
    "by_heading": ("m/rad", "Free motion to a point by the heading"),
}


def _words(name: str) -> tuple[str, str]:
    """Return unit and meaning of a parameter of the driver."""
    return _UNITS[name.removeprefix("driver.").rpartition("_")[0]]
