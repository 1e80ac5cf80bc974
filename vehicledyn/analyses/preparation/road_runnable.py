"""A road vehicle in its manoeuvre as a thing to run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Self

from vehicledyn.analyses.preparation.ports import Ports, WheelPort
from vehicledyn.analyses.preparation.runnable import Vector, index_of, start_values
from vehicledyn.analyses.preparation.seat_figures import seat_channels, seat_figures
from vehicledyn.base.shapes import Hull, Shape
from vehicledyn.multibody.elements.driveline.half_shaft import HalfShaft
from vehicledyn.multibody.model.bodies import Joint
from vehicledyn.multibody.model.system import System
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.road.manoeuvres.manoeuvre import RoadManoeuvre
from vehicledyn.road.vehicle import RoadVehicle
from vehicledyn.symbolic.equations import Channel, Equations

if TYPE_CHECKING:
    from vehicledyn.results.store.layout import SceneItem, SummaryEntry

BEFORE_START = -1.0
"""Time at which a start is balanced: before any manoeuvre has begun [s]."""


@dataclass(frozen=True)
class RoadSubject:
    """A vehicle, fitted with its manoeuvre, that starts straight ahead on its road."""

    vehicle: RoadVehicle
    manoeuvre: RoadManoeuvre
    usual_start: str = "steady"
    balance_time: float = BEFORE_START
    settling: float | None = None

    @property
    def system(self) -> System:
        """The vehicle's system."""
        return self.vehicle.system

    @property
    def ports(self) -> Ports:
        """Chassis, steering rack and wheels of the vehicle."""
        v = self.vehicle
        wheels = (WheelPort(c.name, c.spin, c.is_front, c.is_left) for c in v.corners)
        return Ports(v.chassis, v.rack, v.steering_gain, v.speed, tuple(wheels))

    def with_system(self, system: System) -> Self:
        """Return the vehicle with another system."""
        return replace(self, vehicle=replace(self.vehicle, system=system))

    def in_manoeuvre(self, manoeuvre: RoadManoeuvre) -> Self:
        """Return the vehicle with the key figures of another manoeuvre."""
        return replace(self, manoeuvre=manoeuvre)

    @property
    def given_rates(self) -> dict[str, float]:
        """None; the start gives those of the independent coordinates."""
        return {}

    def parameters_at(self, speed: float) -> dict[str, float]:
        """Return the parameter "speed", which prescribed wheels turn by."""
        return {"speed": speed}

    def start_state(self, equations: Equations, speed: float) -> Vector:
        """Return the start values of the states, level with the road, with rolling wheels."""
        state, chassis = start_values(equations), self.vehicle.chassis

        def index(name: str) -> int:
            return index_of(equations, name)

        height, pose = _on_road(self.vehicle, state[index(f"{chassis}.z")])
        state[index(f"{chassis}.z")] = height
        state[index(f"{chassis}.pitch")] = pose.pitch
        state[index(f"{chassis}.roll")] = pose.roll
        state[index(f"{chassis}.x_rate")] = speed
        state[index(f"{chassis}.z_rate")] = speed * pose.slope
        if self.vehicle.free_wheels:
            for corner in self.vehicle.corners:
                state[index(f"{corner.spin}_rate")] = speed / corner.radius
        for _, shaft, radius in self._half_shafts():
            state[index(f"{shaft}_rate")] = speed / radius
        return state

    def still_state(self, equations: Equations) -> Vector:
        """Return the start at zero speed."""
        return self.start_state(equations, 0.0)

    def balance_pairs(self, equations: Equations, speed: float) -> tuple[list[int], list[int]]:
        """Return the states to move and the rates to balance for an equilibrium.

        Position, heading and wheel angles are held; the speed may change slowly. At a speed,
        free wheels find the spin at which they roll and transient slip its steady value.
        """
        e, vehicle = equations, self.vehicle
        spins = {corner.spin for corner in vehicle.corners}
        shafts = [(part, angle) for part, angle, _ in self._half_shafts()]
        held = {*(f"{vehicle.chassis}.{name}" for name in ("x", "y", "yaw")), *spins}
        turning = _revolving(vehicle.system)
        held |= {angle for _, angle in shafts} | turning
        free, rates = [], []
        for position, velocity in zip(e.positions, e.velocities, strict=True):
            if e.states[position].name not in held:
                free.append(position)
                rates.append(velocity)
        if speed > 0.0:
            rolling = {f"{spin}_rate" for spin in spins if vehicle.free_wheels}
            slips = tuple(f"{corner.name}.tyre." for corner in vehicle.corners)
            if vehicle.free_wheels:
                rolling |= {f"{angle}_rate" for angle in turning.union(a for _, a in shafts)}
            slips += tuple(f"{part}." for part, _ in shafts)
            for index, state in enumerate(e.states):
                if state.name in rolling or state.name.startswith(slips):
                    free.append(index)
                    rates.append(index)
        return free, rates

    def _half_shafts(self) -> list[tuple[str, str, float]]:
        """Return half shafts to wheels: name, coordinate that turns the shaft, wheel's radius."""
        radii = {corner.body: corner.radius for corner in self.vehicle.corners}
        parts = [p for p in self.system.parts if isinstance(p, HalfShaft) and p.wheel in radii]
        last = {body.name: body.joints[-1] for body in self.system.bodies if body.joints}
        joints = ((part, last.get(part.shaft)) for part in parts)
        return [
            (part.name, joint.name, radii[part.wheel])
            for part, joint in joints
            if isinstance(joint, Joint)
        ]

    def scene(self) -> dict[str, SceneItem]:
        """Return what the manoeuvre shows."""
        return self.manoeuvre.scene(self.vehicle)

    def shapes(self) -> tuple[Shape, ...]:
        """Return the hull of the vehicle."""
        return (Hull(self.vehicle.chassis, self.vehicle.chassis, self.vehicle.outline),)

    def plots(self, _: Sequence[Channel]) -> list[dict[str, Any]]:
        """Return the figures of the manoeuvre."""
        return self.manoeuvre.plots(self.vehicle)

    def channels(self, _: Equations) -> list[str]:
        """Return the channels of the manoeuvre's key figures and of those of seats."""
        return [*self.manoeuvre.channels(self.vehicle), *seat_channels(self.system)]

    def summarise(self, recording: Recording) -> list[SummaryEntry]:
        """Return the key figures of the manoeuvre, and the vibration at seats."""
        figures = self.manoeuvre.summarise(recording, self.vehicle)
        return [*figures, *seat_figures(self.system, recording)]


def _revolving(system: System) -> set[str]:
    """Return the coordinates that turn bodies of revolution; nothing depends on their angles."""
    last = (body.joints[-1] for body in system.bodies if body.joints and body.spins_about)
    return {joint.name for joint in last if isinstance(joint, Joint)}


@dataclass(frozen=True)
class _Pose:
    """Pitch and roll of a chassis that stands on a plane [rad], and its slope ahead [1]."""

    pitch: float
    roll: float
    slope: float


def _on_road(vehicle: RoadVehicle, clearance: float) -> tuple[float, _Pose]:
    """Return height and pose of a chassis at the origin, ``clearance`` above its road [m]."""
    ahead, left = (float(g) for g in vehicle.surface.gradient(0.0, 0.0))
    length = math.sqrt(1.0 + ahead * ahead + left * left)
    pose = _Pose(-math.atan(ahead), math.asin(left / length), ahead)
    return float(vehicle.surface.height(0.0, 0.0)) + clearance * length, pose
