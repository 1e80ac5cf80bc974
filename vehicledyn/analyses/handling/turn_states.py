"""The states of a car in a steady turn: which are free, which balance, and which make no odds."""

from __future__ import annotations

import numpy as np

from vehicledyn.analyses.handling.switches import switches_of
from vehicledyn.analyses.handling.tested_car import TestedCar
from vehicledyn.base.errors import NumericalError

_STEP = 1e-6
_SHIFT, _UNMOVED = 0.3, 1e-6
"""Angle by which a coordinate is moved [rad] and the change of a rate that rounding makes [1]."""


class TurnStates:
    """Indices of the states of a car by what they do in a steady turn.

    ``motion`` are the velocities along x and y and the yaw rate; ``rolling`` the rates of wheels
    and shafts that turn, whose angles are named by ``turning``; ``further`` the states without
    velocity that a balance determines. ``free`` are those that a search moves, ``balanced``
    those whose rates it balances. ``integral`` is that of the speed controller, ``pedal`` the one
    of the throttle, None where there is none. ``sticking`` names the states that a steady motion
    leaves as they are, as friction that sticks.
    """

    def __init__(self, car: TestedCar) -> None:
        e, chassis = car.equations, car.vehicle.chassis
        travelling = {f"{chassis}.{name}" for name in ("x", "y", "yaw")}
        pairs = list(zip(e.positions, e.velocities, strict=True))
        turning = {p for p, _ in pairs if _turns_freely(car, p)}
        kept = [(p, v) for p, v in pairs if p not in turning and e.states[p].name not in travelling]
        self.motion = [car.state(f"{chassis}.{name}_rate") for name in ("x", "y", "yaw")]
        # Wheels and shafts turn: their angles make no difference, their rates are constant.
        self.rolling = [v for p, v in pairs if p in turning]
        self.turning = frozenset(e.states[p].name for p in turning)
        self.integral = car.state("drive.speed_error_integral")
        throttle = car.vehicle.throttle
        self.pedal = None if throttle is None else car.state(f"{throttle.switch}.value")
        held = {*e.positions, *e.velocities, *switches_of(e), self.integral, self.pedal}
        further = [k for k in range(len(e.states)) if k not in held]
        moving = [*(p for p, _ in kept), *self.motion, *self.rolling]
        self.further = _determined(car, further, [*moving, *further])
        self.sticking = tuple(e.states[k].name for k in further if k not in self.further)
        self.free = [*moving, *self.further]
        self.balanced = [*(v for _, v in kept), *self.motion, *self.rolling, *self.further]


def _determined(car: TestedCar, further: list[int], free: list[int]) -> list[int]:
    """Return the further states whose rates some free state changes.

    Friction that sticks keeps whatever it has where nothing slides, so no balance determines it; it
    stays as at rest, in the middle of its hysteresis.
    """
    rest = car.standing
    car.kernel.set_parameters(rest.parameters)
    before, _ = car.rates(rest.state, rest.unknowns)
    known = np.zeros(len(further), dtype=bool)
    for k in free:
        moved = rest.state.copy()
        moved[k] += _STEP
        after, _ = car.rates(moved, rest.unknowns)
        known |= after[further] != before[further]
    return [k for k, is_known in zip(further, known, strict=True) if is_known]


def _turns_freely(car: TestedCar, position: int) -> bool:
    """Return whether no rate depends on an angle of the car at rest, as on that of a wheel."""
    states, chassis = car.equations.states, car.vehicle.chassis
    if states[position].unit != "rad" or states[position].name.startswith(f"{chassis}."):
        return False
    rest = car.standing
    car.kernel.set_parameters(rest.parameters)
    before, _ = car.rates(rest.state, rest.unknowns)
    moved = rest.state.copy()
    moved[position] += _SHIFT
    try:
        after, _ = car.rates(moved, rest.unknowns)
    except NumericalError:
        return False
    return bool(np.all(np.abs(after - before) <= _UNMOVED * (1.0 + np.abs(before))))
