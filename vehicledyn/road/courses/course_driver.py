"""The preview driver on a course: he looks one preview time ahead along it.

His position on the course is its station s, a state that follows the foot of the perpendicular
from the chassis's origin, s' = (v·t + k d·t)/(1 - κ e), with the tangent t, the offset e to the
left, the distance d from the place at s and k = 5/s. He asks for the lateral acceleration
a = 2 n·(p(s + v T) - r - v T)/T², n to the left of the chassis, and steers
δ = a (l/v² + K) + K_i ∫ -e dt, within the stops of the rack and with a lag.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from vehicledyn.multibody.model.parts import BasePart, Clock, DrivenMotion, Loads, Output, Situation
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel, Variable

if TYPE_CHECKING:
    from vehicledyn.road.courses.course import Course
    from vehicledyn.road.drivers.preview_driver import PreviewSettings
    from vehicledyn.road.vehicle import RoadVehicle
    from vehicledyn.symbolic.ops import Scalar

NAME = "driver"
_RETURN = 5.0
"""Rate k at which the station returns to the foot of the perpendicular [1/s]."""

_NEAREST = 0.2
"""Smallest 1 - κ e that divides: nearer to the centre of a corner the station goes no faster."""

_SPEED_FLOOR = 1.0
"""Speed below which he steers as at this speed [m/s]."""


@dataclass(frozen=True)
class CourseDriver(BasePart):
    """The driver as a part: rack, its velocity, station and the integral of the offset."""

    vehicle: RoadVehicle
    settings: PreviewSettings
    integral_gain: Scalar
    course: Course

    def states(self) -> tuple[Variable, ...]:
        """Return the four states."""
        return (
            Variable("rack", "m", "Rack displacement of the driver"),
            Variable("rack_rate", "m/s", "Rack velocity of the driver"),
            Variable("station", "m", "Distance along the course"),
            Variable("offset_integral", "m*s", "Integral of the distance left of the course"),
        )

    def motions(self, clock: Clock) -> dict[str, DrivenMotion]:
        """Return the rack as the driver's states."""
        return {self.vehicle.rack: DrivenMotion(clock.states["rack"], clock.states["rack_rate"])}

    def loads(self, situation: Situation) -> Loads:
        """Return the acceleration of the rack and the rates of the states."""
        s, states = self.settings, situation.states
        error = self._wanted_rack(situation) - states["rack"]
        damping = 2.0 * s.lag_damping * s.lag_frequency * states["rack_rate"]
        acceleration = s.lag_frequency * s.lag_frequency * error - damping
        along, offset, pace = self._on_course(situation)
        bend = ops.maximum(1.0 - self.course.curvature(states["station"]) * offset, _NEAREST)
        return Loads(
            rates={
                "rack": states["rack_rate"],
                "rack_rate": acceleration,
                "station": (pace + _RETURN * along) / bend,
                "offset_integral": offset,
            },
            accelerations={self.vehicle.rack: acceleration},
        )

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return station, offset and the rack position wanted."""
        name = self.name
        error = Channel(f"{name}.path_error", "m", "Distance left of the path")
        wanted = Channel(f"{name}.wanted_rack", "m", "Rack displacement the driver wants")
        return (
            Output(error, self._on_course(situation)[1]),
            Output(wanted, self._wanted_rack(situation)),
        )

    def _on_course(self, situation: Situation) -> tuple[Scalar, Scalar, Scalar]:
        """Return distances along and left of the course from its station, and v·t."""
        station = situation.states["station"]
        where = situation.kinematics.position(self.vehicle.chassis)
        velocity = situation.kinematics.velocity(self.vehicle.chassis)
        x, y = self.course.place(station)
        heading = self.course.heading(station)
        c, s = ops.cos(heading), ops.sin(heading)
        dx, dy = where[0] - x, where[1] - y
        return c * dx + s * dy, c * dy - s * dx, c * velocity[0] + s * velocity[1]

    def _wanted_rack(self, situation: Situation) -> Scalar:
        s, v = self.settings, self.vehicle
        where = situation.kinematics.position(v.chassis)
        velocity = situation.kinematics.velocity(v.chassis)
        axis = situation.kinematics.rotation(v.chassis)[:, 0]
        squared = velocity[0] * velocity[0] + velocity[1] * velocity[1]
        speed_squared = ops.maximum(squared, _SPEED_FLOOR**2)
        ahead = situation.states["station"] + s.preview_time * ops.sqrt(speed_squared)
        x, y = self.course.place(ahead)
        dx = x - where[0] - s.preview_time * velocity[0]
        dy = y - where[1] - s.preview_time * velocity[1]
        level = ops.smooth_norm(axis[0], axis[1], 0.0)
        aside = (axis[0] * dy - axis[1] * dx) / level
        acceleration = 2.0 * aside / (s.preview_time * s.preview_time)
        angle = acceleration * (v.wheelbase / speed_squared + s.understeer)
        angle = angle - self.integral_gain * situation.states["offset_integral"]
        wanted = angle / v.steering_gain
        return ops.minimum(ops.maximum(wanted, -s.rack_stop), s.rack_stop)
