"""Derive and compile a vehicle, and bring it to the state it starts from."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vehicledyn.multibody.derivation import derive
from vehicledyn.road.vehicle import RoadVehicle
from vehicledyn.run.vehicle import Target, build_vehicle
from vehicledyn.solve.derivatives import Derivatives
from vehicledyn.solve.equilibrium import assemble
from vehicledyn.solve.equilibrium import find_equilibrium as balance
from vehicledyn.solve.kernel import Backend, Kernel, compile_kernel
from vehicledyn.symbolic.equations import Equations

Vector = NDArray[np.float64]
Progress = Callable[[str, float | None], None]

BALANCE_TOLERANCE = 1e-9
"""Largest acceleration that counts as balanced [m/s², rad/s²]."""

BEFORE_START = -1.0
"""Time at which a start is balanced: before any manoeuvre has begun [s]."""


@dataclass
class Prepared:
    """A vehicle with its equations and kernel; ``derivatives`` are made when first needed."""

    vehicle: RoadVehicle
    equations: Equations
    kernel: Kernel
    _derivatives: list[Derivatives] = field(default_factory=list)

    @property
    def derivatives(self) -> Derivatives:
        """Exact Jacobians of the equations."""
        if not self._derivatives:
            self._derivatives.append(Derivatives(self.equations))
        return self._derivatives[0]

    def index(self, state: str) -> int:
        """Return the index of a state by name."""
        return next(k for k, s in enumerate(self.equations.states) if s.name == state)


@dataclass(frozen=True)
class Point:
    """States and unknowns that fulfil the constraints; ``residual`` the largest unbalance."""

    state: Vector
    unknowns: Vector
    residual: float = 0.0


def prepare(target: Target, *, backend: Backend, progress: Progress) -> Prepared:
    """Return the derived and compiled vehicle of a scenario or model."""
    progress("deriving the equations of motion", None)
    vehicle = build_vehicle(target)
    equations = derive(vehicle.system)
    kernel = compile_kernel(equations, backend=backend, progress=progress)
    return Prepared(vehicle, equations, kernel)


def nominal_point(prepared: Prepared, speed: float) -> Point:
    """Return the vehicle in its nominal position at a forward speed [m/s]."""
    state = _start_state(prepared, speed)
    guess = np.array([u.start for u in prepared.equations.unknowns])
    set_speed(prepared, speed)
    return Point(state, assemble(prepared.kernel, BEFORE_START, state, guess))


def equilibrium_point(prepared: Prepared, speed: float, kind: Literal["static", "steady"]) -> Point:
    """Return the equilibrium of the vehicle, moving at a speed.

    "static" balances the standing vehicle and then gives it the speed; "steady" balances all
    but the slow loss of speed at the speed itself, including the spin of free wheels.
    """
    balanced_speed = 0.0 if kind == "static" else speed
    start = nominal_point(prepared, balanced_speed)
    free, rates = _balance_pairs(prepared, balanced_speed)
    found = balance(
        prepared.equations,
        prepared.kernel,
        time=BEFORE_START,
        state=start.state,
        unknowns=start.unknowns,
        free=free,
        balanced=rates,
        tolerance=BALANCE_TOLERANCE,
        derivatives=prepared.derivatives,
    )
    if balanced_speed == speed:
        return Point(found.state, found.unknowns, found.residual)
    moving = _start_state(prepared, speed)
    positions = list(prepared.equations.positions)
    moving[positions] = found.state[positions]
    set_speed(prepared, speed)
    return Point(moving, found.unknowns, found.residual)


def set_speed(prepared: Prepared, speed: float) -> None:
    """Set the parameter "speed" of the kernel, which prescribed wheels turn by."""
    names = [p.name for p in prepared.equations.parameters]
    values = prepared.kernel.parameters.copy()
    values[names.index("speed")] = speed
    prepared.kernel.set_parameters(values)


def _start_state(prepared: Prepared, speed: float) -> Vector:
    """Return the start values of the states, level with the road, with rolling wheels."""
    state = np.array([s.start for s in prepared.equations.states])
    chassis = prepared.vehicle.chassis
    height, pose = _on_road(prepared.vehicle, state[prepared.index(f"{chassis}.z")])
    state[prepared.index(f"{chassis}.z")] = height
    state[prepared.index(f"{chassis}.pitch")] = pose.pitch
    state[prepared.index(f"{chassis}.roll")] = pose.roll
    state[prepared.index(f"{chassis}.x_rate")] = speed
    state[prepared.index(f"{chassis}.z_rate")] = speed * pose.slope
    if prepared.vehicle.free_wheels:
        for corner in prepared.vehicle.corners:
            state[prepared.index(f"{corner.spin}_rate")] = speed / corner.radius
    return state


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


def _balance_pairs(prepared: Prepared, speed: float) -> tuple[list[int], list[int]]:
    """Return the states to move and the rates to balance for an equilibrium.

    Position, heading and wheel angles are held; the speed may change slowly. At a speed, free
    wheels find the spin at which they roll and transient slip its steady value.
    """
    e, vehicle = prepared.equations, prepared.vehicle
    spins = {corner.spin for corner in vehicle.corners}
    held = {*(f"{vehicle.chassis}.{name}" for name in ("x", "y", "yaw")), *spins}
    free, rates = [], []
    for position, velocity in zip(e.positions, e.velocities, strict=True):
        if e.states[position].name not in held:
            free.append(position)
            rates.append(velocity)
    if speed > 0.0:
        rolling = {f"{spin}_rate" for spin in spins if vehicle.free_wheels}
        slips = tuple(f"{corner.name}.tyre." for corner in vehicle.corners)
        for index, state in enumerate(e.states):
            if state.name in rolling or state.name.startswith(slips):
                free.append(index)
                rates.append(index)
    return free, rates
