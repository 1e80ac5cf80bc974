"""What a road vehicle offers to manoeuvres, drivers, plots and summaries."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace

from vehicledyn.multibody.model.bodies import Joint, Turn
from vehicledyn.multibody.model.parts import Part
from vehicledyn.multibody.model.system import System
from vehicledyn.road.surfaces.surface import RoadSurface
from vehicledyn.road.tyres.tyre import Tyre
from vehicledyn.road.wheel.relaxation import Relaxation
from vehicledyn.symbolic.ops import Scalar


@dataclass(frozen=True)
class RoadOptions:
    """Parts that a scenario chooses for a road vehicle.

    ``contact`` is "disc", "vertical", "tangent_plane" or "lowest_point" (see
    :class:`vehicledyn.road.wheel.road_wheel.RoadWheel`). ``free_wheels`` says whether the wheels
    turn freely or at the constant rate speed / unloaded radius; ``speed`` is the forward speed at
    the start [m/s].
    """

    front_tyre: Tyre
    rear_tyre: Tyre
    surface: RoadSurface
    free_wheels: bool
    speed: float
    contact: str = "disc"
    relaxation: Relaxation | None = None


@dataclass(frozen=True)
class Corner:
    """A wheel: its body, its spin coordinate and its place; ``radius`` unloaded [m]."""

    name: str
    body: str
    spin: str
    is_front: bool
    is_left: bool
    radius: float


@dataclass(frozen=True)
class Pedal:
    """A pedal: its switch from 0 to 1, and the torque of brakes or drive at full pedal [N m]."""

    switch: str
    torque: Scalar


@dataclass(frozen=True)
class RoadVehicle:
    """A road vehicle: its system and the names others need.

    ``chassis`` is the body whose coordinates are ``<chassis>.x, y, z, yaw, pitch, roll``
    (position of its origin, ISO 8855 angles); ``rack`` is the driven coordinate of the steering
    rack [m] along +y; ``steering_gain`` the road-wheel angle to the left that it gives [rad/m],
    negative for tie rods behind the axle.
    ``outline`` holds the corners of the body seen from above in chassis axes, shape (m, 2) [m].
    ``speed`` is the symbol of the forward speed at the start [m/s], ``surface`` the road with
    numbers. ``drive`` is the coordinate that a drive turns; empty where it turns all wheels.
    ``steering_ratio`` is the steering-wheel angle over that of the front wheels; 1 where the model
    has no steering wheel, and steering angles are then those of the front wheels.
    ``throttle`` and ``brake`` are the pedals of the car's own engine and brakes, if it has any.
    """

    system: System
    chassis: str
    rack: str
    steering_gain: Scalar
    wheelbase: Scalar
    front_distance: Scalar
    outline: tuple[tuple[float, float], ...]
    corners: tuple[Corner, ...]
    free_wheels: bool
    speed: Scalar
    surface: RoadSurface
    drive: str = ""
    steering_ratio: Scalar = 1.0
    throttle: Pedal | None = None
    brake: Pedal | None = None

    def worth(self, expression: Scalar) -> float:
        """Return what an expression of the vehicle's parameters is worth."""
        from vehicledyn.symbolic import ops

        entries = self.system.table.entries
        symbols = ops.column([entry.symbol for entry in entries])
        number = ops.numeric([symbols], ops.column([expression]))
        return float(number([entry.value for entry in entries]).ravel()[0])

    def worth_slopes(self, expression: Scalar) -> dict[str, float]:
        """Return the derivatives of what an expression is worth by the parameters in it."""
        from vehicledyn.symbolic import ops

        entries = self.system.table.entries
        symbols = ops.column([entry.symbol for entry in entries])
        slopes = ops.numeric([symbols], ops.jacobian(ops.column([expression]), symbols))
        found = slopes([entry.value for entry in entries]).ravel()
        return {e.name: float(d) for e, d in zip(entries, found, strict=True) if d}

    @property
    def articulation(self) -> str | None:
        """The yaw coordinate of the first body behind the chassis on wheels of its own, if any.

        Such a body turns on its coupling; one that also moves along an axis is an axle.
        """
        parents = {body.name: body.parent for body in self.system.bodies}
        carried: Counter[str] = Counter()
        for corner in self.corners:
            name = corner.body
            while name in parents and name != self.chassis:
                carried[name] += 1
                name = parents[name]
        for body in self.system.bodies:
            joints = [joint for joint in body.joints if isinstance(joint, Joint)]
            yaws = [joint.name for joint in joints if joint.kind == "R3"]
            slides = any(joint.kind.startswith("T") for joint in joints)
            if carried[body.name] > 1 and yaws and not slides:
                return yaws[0]
        return None

    def with_parts(self, *parts: Part) -> RoadVehicle:
        """Return the vehicle with parts acting on it, a foot in place of a pedal's switch."""
        return replace(self, system=self.system.with_surroundings(*parts))

    def with_free_steering(self) -> RoadVehicle:
        """Return the vehicle whose rack nothing drives; forces move it."""

        def freed(item: Joint | Turn) -> Joint | Turn:
            if not isinstance(item, Joint) or item.name != self.rack:
                return item
            return replace(item, role="independent")

        bodies = tuple(
            replace(body, joints=tuple(map(freed, body.joints))) for body in self.system.bodies
        )
        return replace(self, system=replace(self.system, bodies=bodies))
