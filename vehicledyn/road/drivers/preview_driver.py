"""Preview driver: steers so that the car would meet the path one preview time ahead.

From its position y, lateral velocity ẏ and the path's y at x + ẋ T the driver asks for the
lateral acceleration a = 2 (y_path - y - ẏ T)/T², which would close the error in the preview
time T, and steers δ = a (l/v² + K) for it (single-point optimal preview control, MacAdam 1980,
J. Dyn. Sys. Meas. Control 102(3), 188-190). Arms and nerves lag: the rack follows as a damped
second-order system, within its stops.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from vehicledyn.multibody.model.parts import BasePart, Clock, DrivenMotion, Loads, Output, Situation
from vehicledyn.road.vehicle import RoadVehicle
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel, Variable
from vehicledyn.symbolic.ops import Scalar

SPEED_FLOOR = 1.0
"""Speed below which a driver steers as at this speed [m/s]."""


class PreviewSettings(Protocol):
    """Settings of the driver, see :class:`vehicledyn.road.drivers.preview.Preview`."""

    @property
    def preview_time(self) -> float:
        """How far ahead the driver looks [s]."""

    @property
    def understeer(self) -> float:
        """Understeer the driver makes up for [rad s²/m]."""

    @property
    def lag_frequency(self) -> float:
        """Bandwidth of arms and nerves [rad/s]."""

    @property
    def lag_damping(self) -> float:
        """Damping ratio of arms and nerves [1]."""

    @property
    def rack_stop(self) -> float:
        """Largest rack displacement [m]."""


@dataclass(frozen=True)
class PreviewDriver(BasePart):
    """The preview driver as a part: two states, rack position and velocity."""

    vehicle: RoadVehicle
    settings: PreviewSettings
    path: Callable[[Scalar], Scalar]

    def states(self) -> tuple[Variable, ...]:
        """Return rack position and velocity."""
        return (
            Variable("rack", "m", "Rack displacement of the driver"),
            Variable("rack_rate", "m/s", "Rack velocity of the driver"),
        )

    def motions(self, clock: Clock) -> dict[str, DrivenMotion]:
        """Return the rack as the driver's states."""
        return {self.vehicle.rack: DrivenMotion(clock.states["rack"], clock.states["rack_rate"])}

    def loads(self, situation: Situation) -> Loads:
        """Return the acceleration of the rack towards what the driver wants."""
        s, states = self.settings, situation.states
        error = self._wanted_rack(situation) - states["rack"]
        damping = 2.0 * s.lag_damping * s.lag_frequency * states["rack_rate"]
        acceleration = s.lag_frequency * s.lag_frequency * error - damping
        return Loads(
            rates={"rack": states["rack_rate"], "rack_rate": acceleration},
            accelerations={self.vehicle.rack: acceleration},
        )

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the lateral error to the path and the rack position wanted."""
        where = situation.kinematics.position(self.vehicle.chassis)
        error = where[1] - self.path(where[0])
        name = self.name
        return (
            Output(Channel(f"{name}.path_error", "m", "Distance left of the path", "world"), error),
            Output(
                Channel(f"{name}.wanted_rack", "m", "Rack displacement the driver wants"),
                self._wanted_rack(situation),
            ),
        )

    def _wanted_rack(self, situation: Situation) -> Scalar:
        s, v = self.settings, self.vehicle
        where = situation.kinematics.position(v.chassis)
        velocity = situation.kinematics.velocity(v.chassis)
        ahead = self.path(where[0] + s.preview_time * velocity[0])
        error = ahead - where[1] - s.preview_time * velocity[1]
        acceleration = 2.0 * error / (s.preview_time * s.preview_time)
        squared = velocity[0] * velocity[0] + velocity[1] * velocity[1]
        speed_squared = ops.maximum(squared, SPEED_FLOOR**2)
        angle = acceleration * (v.wheelbase / speed_squared + s.understeer)
        wanted = angle / v.steering_gain
        return ops.minimum(ops.maximum(wanted, -s.rack_stop), s.rack_stop)
