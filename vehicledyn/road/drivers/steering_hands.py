"""Hands or a robot at the steering wheel: the rack follows what is wanted, with lag and limits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from vehicledyn.multibody.model.parts import BasePart, Clock, DrivenMotion, Loads, Output, Situation
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel, Variable

if TYPE_CHECKING:
    from vehicledyn.road.drivers.steering_driver import SteeringDriver
    from vehicledyn.road.vehicle import RoadVehicle
    from vehicledyn.symbolic.ops import Scalar

SPEED_FLOOR = 1.0
"""Speed below which a driver steers as at this speed [m/s]."""


@dataclass(frozen=True)
class SteeringHands(BasePart):
    """Two states, rack position and velocity; ``wanted`` gives the front-wheel angle [rad].

    q̈ = 2 ζ ω (v - q̇) with v = ω/(2 ζ) (q_wanted - q), both within their limits.
    """

    vehicle: RoadVehicle
    settings: SteeringDriver
    path: Callable[[Scalar], Scalar]
    wanted: Callable[[Situation], Scalar]

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
        error = self._rack(situation) - states["rack"]
        speed = s.lag_frequency / (2.0 * s.lag_damping) * error
        if s.rack_speed is not None:
            speed = _within(speed, s.rack_speed)
        acceleration = 2.0 * s.lag_damping * s.lag_frequency * (speed - states["rack_rate"])
        if s.rack_acceleration is not None:
            acceleration = _within(acceleration, s.rack_acceleration)
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
                self._rack(situation),
            ),
        )

    def _rack(self, situation: Situation) -> Scalar:
        return _within(self.wanted(situation) / self.vehicle.steering_gain, self.settings.rack_stop)


def _within(value: Scalar, limit: Scalar) -> Scalar:
    return ops.minimum(ops.maximum(value, -limit), limit)


def slope_of(path: Callable[[Scalar], Scalar], x: Scalar) -> Scalar:
    """Return dy/dx of a path at x [1]."""
    at = ops.symbol("path_x")
    slope = ops.derivative(ops.scalar(path(at)), at, 1.0)
    return ops.substitute(slope, at, x)


def speed_of(situation: Situation, body: str) -> Scalar:
    """Return the horizontal speed of a body, at least :data:`SPEED_FLOOR` [m/s]."""
    velocity = situation.kinematics.velocity(body)
    squared = velocity[0] * velocity[0] + velocity[1] * velocity[1]
    return ops.sqrt(ops.maximum(squared, SPEED_FLOOR**2))
