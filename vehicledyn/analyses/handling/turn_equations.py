"""The equations of a steady turn and their exact derivatives, with loops that stay closed.

In axes along the heading the velocity is constant but for the acceleration a along the path, so
ẍ = a v_x/v - r v_y and ÿ = a v_y/v + r v_x, and wheels gain speed in the same proportion. These
accelerations are taken from the rates of the car; the rest, and what is demanded, must vanish.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.handling.tested_car import CarPoint, TestedCar
from vehicledyn.analyses.handling.turn_states import TurnStates
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.local_slopes import LocalSlopes
from vehicledyn.symbolic import ops

Vector = NDArray[np.float64]
Demand = Literal["steering", "lateral_acceleration", "curvature"]

BRAKE_SCALE = 1e3
"""Unit of the brake torque among the unknowns [N m]."""

_VALUE_STEP = 1e-5
"""Part of a value between which and itself the demands on its turn are differenced."""

_UNHELD = 1e-6
"""Rate at which its own turning slows down a wheel in the air, below any on the ground [1/s]."""

_DEMANDS = ("steering", "lateral_acceleration", "curvature", "sideslip")


@dataclass(frozen=True)
class TurnDemand:
    """A demand on a steady turn at a speed along the path [m/s].

    ``value`` is the steering angle [rad], the lateral acceleration r v [m/s²] or the curvature r/v
    of the path [1/m], as ``demand`` says. ``acceleration`` is that along the path [m/s²]: driven
    by the drive, or braked by the brakes if negative. A side-slip angle [rad] replaces the balance
    about the vertical, as if a rig held the car at it.
    """

    speed: float
    demand: Demand
    value: float
    acceleration: float = 0.0
    sideslip: float | None = None


TurnOf = Callable[[float], TurnDemand]
"""The demand on a turn of a value, such as a lateral acceleration."""


class TurnEquations:
    """What is unbalanced in a motion of a car, as equations of the unknowns of a turn.

    The unknowns are the free states, the steering-wheel angle [rad] and the drive: its torque
    [N m], or the throttle where the car has one, and the brakes' torque [kN m] if negative.
    """

    def __init__(self, car: TestedCar, states: TurnStates) -> None:
        self._car, self._states = car, states
        throttle = car.vehicle.throttle
        self._full = 1.0 if throttle is None else car.worth(throttle.torque)
        self._angle = car.table_places("test.steering.angle")
        self._brake = car.table_places("test.brake_torque")
        self._speed = car.place("speed")
        self._gain = car.place("test.integral_gain")
        moving = {*states.free, states.integral, states.pedal}
        self._still = [k for k in range(len(car.equations.states)) if k not in moving]
        self._yaw_row = states.balanced.index(states.motion[2])

    @cached_property
    def _slopes(self) -> LocalSlopes:
        """All rows that a turn may need and those of the loops, by all that may move.

        In order: what is unbalanced, speed, one row for each of the demands, loops; by the
        free states, angle, drive, brake torque, speed and acceleration that are asked for, and the
        algebraic unknowns.
        """
        e, s = self._car.equations, self._states
        angle, drive, brake, speed, along = (ops.symbol(n) for n in ("a", "d", "b", "v", "along"))
        ahead, aside, yaw_rate = (e.state[k] for k in s.motion)
        path_speed = ops.sqrt(ahead * ahead + aside * aside)
        growth = along / path_speed
        unbalanced = e.rate + 0.0
        unbalanced[s.motion[0]] -= growth * ahead - yaw_rate * aside
        unbalanced[s.motion[1]] -= growth * aside + yaw_rate * ahead
        for k in s.rolling:
            unbalanced[k] -= growth * e.state[k]
        demands = angle, yaw_rate * path_speed, yaw_rate / path_speed, ops.atan2(aside, ahead)
        rows = ops.stacked(unbalanced[s.balanced], path_speed, *demands, e.residual)
        named = {self._speed: ahead, **dict.fromkeys(self._angle, angle)}
        named |= dict.fromkeys(self._brake, brake)
        integral = drive
        changes = [(e.parameter[k], value) for k, value in named.items()]
        if s.pedal is not None:
            changes.append((e.state[s.pedal], drive))
            integral = drive * self._full / e.parameter[self._gain]
        changes.append((e.state[s.integral], integral))
        rows = ops.substitute(
            rows, *(ops.stacked(*column) for column in zip(*changes, strict=True))
        )
        moving = ops.stacked(e.state[s.free], angle, drive, brake, speed, along, e.algebraic)
        still = ops.stacked(e.parameter, e.state[self._still], e.time)
        is_compiled = self._car.kernel.backend == "compiled"
        return LocalSlopes(rows, moving, still, e.tables, compiled=is_compiled)

    def unknowns(self, turn: TurnDemand, point: CarPoint) -> Vector:
        """Return the unknowns of the search for a turn at a point, shape (n_unknowns,)."""
        s = self._states
        drive = point.state[s.integral if s.pedal is None else s.pedal]
        braked = point.parameters[self._brake[0]] / BRAKE_SCALE
        if turn.acceleration < 0.0 and braked > 0.0:
            drive = -braked
        return np.concatenate([point.state[s.free], [point.parameters[self._angle[0]], drive]])

    def moved(self, turn: TurnDemand, point: CarPoint, x: Vector) -> CarPoint:
        """Return a point with the unknowns of a turn put in, and its loops closed.

        Raises
        ------
        NumericalError
            If the loops do not close.
        """
        s, car = self._states, self._car
        state, parameters = point.state.copy(), point.parameters.copy()
        state[s.free] = x[:-2]
        parameters[self._speed] = state[s.motion[0]]
        parameters[self._angle] = x[-2]
        drive, braked = _split(turn, float(x[-1]))
        parameters[self._brake] = braked
        state[s.integral] = drive
        if s.pedal is not None:
            state[s.pedal] = drive
            state[s.integral] = drive * self._full / parameters[self._gain]
        car.kernel.set_parameters(parameters)
        return CarPoint(state, car.rates(state, point.unknowns)[1], parameters)

    def at(self, turn: TurnDemand, point: CarPoint, x: Vector) -> tuple[Vector, Vector]:
        """Return what is unbalanced at a point with its unknowns, and the derivatives.

        The columns are those of the unknowns, then those of the speed and acceleration of the turn
        that is asked for.

        Raises
        ------
        NumericalError
            If the loops are singular there.
        """
        n = len(x) - 2
        drive, braked = _split(turn, float(x[-1]))
        asked = [x[-2], drive, braked, turn.speed, turn.acceleration]
        moving = np.concatenate([x[:-2], asked, point.unknowns])
        still = np.concatenate([point.parameters, point.state[self._still], [0.0]])
        values, slopes = self._slopes.at(moving, still)
        slopes = _along_loops(slopes, n + 5, len(point.unknowns))
        balances, first = len(self._states.balanced), len(self._states.balanced) + 1
        wanted = first + _DEMANDS.index(turn.demand)
        rows = [*range(balances), balances, wanted]
        residual = values[rows]
        residual[-2:] -= turn.speed, turn.value
        if turn.sideslip is not None:
            rows[self._yaw_row] = first + _DEMANDS.index("sideslip")
            residual[self._yaw_row] = values[rows[self._yaw_row]] - turn.sideslip
        jacobian = slopes[rows]
        # Braked or driven, it is one unknown.
        by_drive = jacobian[:, n + 1] if braked == 0.0 else -BRAKE_SCALE * jacobian[:, n + 2]
        by_turn = jacobian[:, n + 3 :]
        by_turn[balances, 0] -= 1.0
        return residual, np.column_stack([jacobian[:, : n + 1], by_drive, by_turn])

    def hold_wheels_in_air(self, point: CarPoint, jacobian: Vector) -> None:
        """Let wheels in the air that nothing slows down keep their rate, in slopes of :meth:`at`.

        Any rate is a balance of theirs, and the determinant would have the sign of rounding. The
        residual stays, so that a wheel in the air that is driven is in none.
        """
        s = self._states
        places = {k: (s.balanced.index(k), s.free.index(k)) for k in s.rolling}
        loose = [k for k, place in places.items() if abs(jacobian[place]) < _UNHELD]
        if not loose:
            return
        outputs = self._car.outputs(point)
        for corner in self._car.vehicle.corners:
            k = self._car.state(f"{corner.spin}_rate")
            if k in loose and outputs[f"{corner.name}.tyre.normal_force"] <= 0.0:
                row, column = places[k]
                jacobian[row] = 0.0
                jacobian[row, column] = -1.0

    def along(self, turn: TurnOf, value: float, jacobian: Vector) -> Vector:
        """Return the derivative by the value of a turn, from those that :meth:`at` gives.

        Parameters
        ----------
        turn
            The demand of a value, whose demand on speed, acceleration and turn are differenced.
        value
            A value greater than zero.
        jacobian
            Derivatives at that value.
        """
        step = _VALUE_STEP * value
        after, before = turn(value + step), turn(value - step)
        speed, acceleration, demand = (
            (getattr(after, name) - getattr(before, name)) / (2.0 * step)
            for name in ("speed", "acceleration", "value")
        )
        column = jacobian[:, -2] * speed + jacobian[:, -1] * acceleration
        column[-1] -= demand
        if after.sideslip is not None and before.sideslip is not None:
            column[self._yaw_row] -= (after.sideslip - before.sideslip) / (2.0 * step)
        return np.asarray(column)


def _split(turn: TurnDemand, drive: float) -> tuple[float, float]:
    """Return what drives and the torque of the brakes [N m].

    Where the tyres slow the car more than wanted, it is the drive that acts.
    """
    if turn.acceleration < 0.0:
        return max(drive, 0.0), max(-drive, 0.0) * BRAKE_SCALE
    return drive, 0.0


def _along_loops(slopes: Vector, n_known: int, n_unknowns: int) -> Vector:
    """Return derivatives by what is known with the unknowns keeping the loops closed.

    The rows of the loops are the last ones and stay out.
    """
    known, followed = slopes[:, :n_known], slopes[:, n_known:]
    if not n_unknowns:
        return known
    try:
        follow = np.linalg.solve(followed[-n_unknowns:], known[-n_unknowns:])
    except np.linalg.LinAlgError:
        raise NumericalError("the loops of the car are singular in this turn") from None
    return np.asarray(known[:-n_unknowns] - followed[:-n_unknowns] @ follow)
