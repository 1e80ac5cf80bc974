"""Steady cornering without time simulation: states that turn about the vertical unchanged.

In a steady turn the chassis keeps height, pitch and roll, all springs keep their length, and the
velocity turns with the yaw rate r: ẍ = -r v_y, ÿ = r v_x in axes along the heading. Newton's
method balances accelerations, wheel spins and further states of a car in this motion.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.newton import solve_damped
from vehicledyn.analyses.handling.switches import Switches
from vehicledyn.analyses.handling.tested_car import CarPoint, TestedCar
from vehicledyn.base.errors import NumericalError
from vehicledyn.road.manoeuvres.speed_control import SpeedControl

Vector = NDArray[np.float64]
Demand = Literal["steering", "lateral_acceleration", "curvature"]

BALANCED = 1e-7
"""Largest acceleration that counts as balanced [m/s², rad/s²]."""

_ITERATIONS = 15
_STEP = 1e-6
_SHIFT, _UNMOVED = 0.3, 1e-6
"""Angle by which a coordinate is moved [rad] and the change of a rate that rounding makes [1]."""

_SHAFT_STEPS = 3
"""Steps towards shafts that turn with their wheels; between them couplings slip or stick."""

_CHANGES = 20
"""Most changes of gear on the way to a steady turn."""

_USUAL_SPEED, _GROWTH = 20.0, 0.5
"""Speed [m/s] and acceleration [m/s²] at which the drive is measured."""

_BRAKE_SCALE = 1e3
"""Unit of the brake torque among the unknowns [N m]."""

LEAST_SIZE = 1e-3
"""Least size that an unknown is measured by."""

_PARTS_BEYOND = (2.0, 1.0, 0.3, 0.1, 0.03)
"""How far behind the last turn of a curve the next one is looked for, as parts of the distance of
the last two."""

_MOST_ASIDE = 0.5
"""Part of the way ahead by which the next turn may lie aside of it, so that it is on the curve."""


@dataclass(frozen=True)
class Turn:
    """A demand on a steady turn at a forward speed [m/s].

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


class SteadyTurn:
    """Finds steady turns of a car, each near a point known before.

    ``sticking`` names the states that a steady motion leaves as they are, as friction that sticks.
    """

    def __init__(self, car: TestedCar) -> None:
        self.car = car
        e, chassis = car.equations, car.vehicle.chassis
        travelling = {f"{chassis}.{name}" for name in ("x", "y", "yaw")}
        pairs = list(zip(e.positions, e.velocities, strict=True))
        turning = {p for p, _ in pairs if _turns_freely(car, p)}
        kept = [(p, v) for p, v in pairs if p not in turning and e.states[p].name not in travelling]
        self._motion = [car.state(f"{chassis}.{name}_rate") for name in ("x", "y", "yaw")]
        # Wheels and shafts turn: their angles make no difference, their rates are constant.
        self._rolling = [v for p, v in pairs if p in turning]
        self.turning = frozenset(e.states[p].name for p in turning)
        coordinates = {*e.positions, *e.velocities}
        self._integral = car.state("drive.speed_error_integral")
        self._switches = Switches(car)
        throttle = car.vehicle.throttle
        self._pedal = None if throttle is None else car.state(f"{throttle.switch}.value")
        self._full = 1.0 if throttle is None else car.worth(throttle.torque)
        held = {*coordinates, *self._switches.states, self._integral, self._pedal}
        further = [k for k in range(len(e.states)) if k not in held]
        moving = [*(p for p, _ in kept), *self._motion, *self._rolling]
        determined = _determined(car, further, [*moving, *further])
        self.sticking = tuple(e.states[k].name for k in further if k not in determined)
        self._further = further = determined
        self._free = [*moving, *further]
        self._balanced = [*(v for _, v in kept), *self._motion, *self._rolling, *further]
        self._angle = car.table_places("test.steering.angle")
        self._brake = car.table_places("test.brake_torque")

    def straight(self, speed: float) -> CarPoint:
        """Return straight running at a speed [m/s].

        Raises
        ------
        NumericalError
            If there is no such motion.
        """
        car, start = self.car, self.car.standing
        state = start.state.copy()
        state[self._motion[0]] = speed
        for corner in car.vehicle.corners:
            state[car.state(f"{corner.spin}_rate")] = speed / corner.radius
        guess = CarPoint(self._with_shafts(state, start), start.unknowns, start.parameters)
        return self.find(Turn(speed, "steering", 0.0), guess)

    def _with_shafts(self, state: Vector, at: CarPoint) -> Vector:
        """Return a state with the shafts of the driveline turning as its wheels drive them.

        Half shafts and couplings then keep their twist, as well as the shafts' rates allow.
        """
        spins = {self.car.state(f"{corner.spin}_rate") for corner in self.car.vehicle.corners}
        shafts = [k for k in self._rolling if k not in spins]
        if not shafts or not self._further:
            return state
        state = state.copy()
        self.car.kernel.set_parameters(at.parameters)
        for _ in range(_SHAFT_STEPS):
            twisting, columns = self._twisting(state, at), []
            for k in shafts:
                other = state.copy()
                other[k] += 1.0
                columns.append(self._twisting(other, at) - twisting)
            slopes = np.stack(columns, axis=1)
            state[shafts] -= np.linalg.lstsq(slopes, twisting, rcond=1e-6)[0]
        return state

    def _twisting(self, state: Vector, at: CarPoint) -> Vector:
        return self.car.rates(state, at.unknowns)[0][self._further]

    def find(self, turn: Turn, guess: CarPoint) -> CarPoint:
        """Return the steady turn near a guess, in the gear that the car drives it in.

        Raises
        ------
        NumericalError
            If Newton's method finds none, or if the car changes its gears on and on.
        """
        for _ in range(_CHANGES):
            found = self._balance(turn, guess)
            changed = self._switches.settled(found)
            if changed is None:
                return found
            state = self._with_shafts(changed.state, changed)
            guess = CarPoint(state, changed.unknowns, changed.parameters)
        raise NumericalError(
            f"no steady turn at {turn.speed:g} m/s: events reset switches of the car after every "
            "balance, as a gearbox does that changes up and down at this speed"
        )

    def _balance(self, turn: Turn, guess: CarPoint) -> CarPoint:
        search = _Search(self, turn, guess)
        found = solve_damped(
            search.evaluate,
            self.unknowns(turn, guess),
            tolerance=BALANCED,
            max_iterations=_ITERATIONS,
            persistent=False,
        )
        if not found.solved:
            worst = float(np.abs(found.residual).max())
            pressed = self._pedal is not None and turn.acceleration >= 0.0 and found.point[-1] > 1.0
            raise NumericalError(
                f"no steady turn with {turn.demand.replace('_', ' ')} {turn.value:.6g} at "
                f"{turn.speed:g} m/s: {worst:.2g} m/s^2 stays unbalanced"
                + (" at full throttle" if pressed else "")
            )
        if self._pedal is not None and found.point[-1] < 0.0 <= turn.acceleration:
            raise NumericalError(f"the car gains speed at {turn.speed:g} m/s without throttle")
        return search.point(found.point)

    def beyond(
        self,
        turn: Callable[[float], Turn],
        before: tuple[float, CarPoint],
        last: tuple[float, CarPoint],
        most: float,
    ) -> tuple[float, CarPoint] | None:
        """Return the next turn along a curve of turns and its value, None if there is none near.

        The value is an unknown beside the others. At a limit it is less than the last one.

        Parameters
        ----------
        turn
            The demand of a value.
        before, last
            Two turns of the curve with their values.
        most
            Most that the value may grow by.
        """
        search = _Search(self, turn(last[0]), last[1])
        rows = [np.append(self.unknowns(turn(v), point), v) for v, point in (before, last)]
        scale = np.maximum(np.abs(rows).max(axis=0), LEAST_SIZE)
        way = (rows[1] - rows[0]) / scale
        length = float(np.linalg.norm(way))
        for part in _PARTS_BEYOND:
            ahead = rows[1] + part * (rows[1] - rows[0])

            def evaluate(x: Vector, ahead: Vector = ahead) -> tuple[Vector, Vector]:
                normal = way / length / scale
                return search.evaluate_along(turn, x, normal, float(normal @ (x - ahead)))

            try:
                found = solve_damped(
                    evaluate,
                    ahead,
                    tolerance=BALANCED,
                    max_iterations=_ITERATIONS,
                    persistent=False,
                )
            except NumericalError:
                continue  # so far ahead the loops do not close
            aside = float(np.linalg.norm((found.point - ahead) / scale))
            value = float(found.point[-1])
            is_near = aside <= _MOST_ASIDE * part * length and value <= last[0] + most
            if found.solved and is_near:
                search.turn = turn(value)
                return value, search.point(found.point[:-1])
        return None

    def orientation(self, turn: Turn, point: CarPoint) -> int:
        """Return the sign of the Jacobian's determinant, which changes where a curve comes back."""
        _, jacobian = _Search(self, turn, point).evaluate(self.unknowns(turn, point))
        return int(np.linalg.slogdet(jacobian)[0])

    def unknowns(self, turn: Turn, point: CarPoint) -> Vector:
        """Return the unknowns of the search for a turn at a point, shape (n_unknowns,)."""
        torque = point.state[self._integral if self._pedal is None else self._pedal]
        braked = point.parameters[self._brake[0]] / _BRAKE_SCALE
        if turn.acceleration < 0.0 and braked > 0.0:
            torque = -braked
        return np.concatenate([point.state[self._free], [point.parameters[self._angle[0]], torque]])

    def yaw_acceleration(self, point: CarPoint) -> float:
        """Return the yaw acceleration at a point [rad/s²]; zero in a steady turn."""
        self.car.kernel.set_parameters(point.parameters)
        return float(self.car.rates(point.state, point.unknowns)[0][self._motion[2]])

    def residual(self, turn: Turn, point: CarPoint, rates: Vector) -> Vector:
        """Return what is unbalanced in a motion, with the demands on speed and turn last."""
        ahead, aside, yaw_rate = (float(point.state[k]) for k in self._motion)
        wanted = np.zeros(len(self.car.equations.states))
        speed = float(np.hypot(ahead, aside))
        growth = turn.acceleration / speed
        wanted[self._motion[0]] = growth * ahead - yaw_rate * aside
        wanted[self._motion[1]] = growth * aside + yaw_rate * ahead
        wanted[self._rolling] = growth * point.state[self._rolling]
        given = {
            "steering": float(point.parameters[self._angle[0]]),
            "lateral_acceleration": yaw_rate * speed,
            "curvature": yaw_rate / speed,
        }[turn.demand]
        unbalanced = rates - wanted
        if turn.sideslip is not None:
            unbalanced[self._motion[2]] = float(np.arctan2(aside, ahead)) - turn.sideslip
        gap = given - turn.value
        return np.append(unbalanced[self._balanced], [ahead - turn.speed, gap])

    def moved(self, turn: Turn, point: CarPoint, x: Vector) -> CarPoint:
        """Return a point with the unknowns of the search put in."""
        state, parameters = point.state.copy(), point.parameters.copy()
        state[self._free] = x[:-2]
        parameters[self.car.place("speed")] = turn.speed
        parameters[self._angle] = x[-2]
        drive, braked = float(x[-1]), 0.0
        if turn.acceleration < 0.0:
            # Where the tyres slow the car more than wanted, it is the drive that acts.
            drive, braked = max(drive, 0.0), max(-drive, 0.0)
        parameters[self._brake] = braked * _BRAKE_SCALE
        if self._pedal is None:
            state[self._integral] = drive
        else:
            gain = parameters[self.car.place("test.integral_gain")]
            state[self._pedal], state[self._integral] = drive, drive * self._full / gain
        return CarPoint(state, point.unknowns, parameters)


def solver_for(car: TestedCar) -> SteadyTurn:
    """Return the solver of a car, whose speed controller fits its mass and driveline.

    An error of 1 m/s asks for 1 m/s², and its integral for 0.3 m/s² a second.

    Raises
    ------
    NumericalError
        If the car does not run straight.
    """
    solver = SteadyTurn(car)
    held = solver.straight(_USUAL_SPEED)
    faster = solver.find(Turn(_USUAL_SPEED, "steering", 0.0, _GROWTH), held)
    torques = [car.outputs(point)["drive.torque"] for point in (held, faster)]
    gain = abs(torques[1] - torques[0]) / _GROWTH
    car.hold_speed_by(SpeedControl(proportional_gain=gain, integral_gain=0.3 * gain))
    return solver


def _determined(car: TestedCar, further: list[int], free: list[int]) -> list[int]:
    """Return the further states whose rates some free state changes.

    Friction that sticks keeps whatever it has where nothing slides, so no balance tells it; it
    stays as at rest, in the middle of its hysteresis.
    """
    rest = car.standing
    car.kernel.set_parameters(rest.parameters)
    before, _ = car.rates(rest.state, rest.unknowns)
    told = np.zeros(len(further), dtype=bool)
    for k in free:
        moved = rest.state.copy()
        moved[k] += _STEP
        after, _ = car.rates(moved, rest.unknowns)
        told |= after[further] != before[further]
    return [k for k, is_told in zip(further, told, strict=True) if is_told]


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


class _Search:
    """Residual and Jacobian of the search for one turn; the loops stay closed on the way."""

    def __init__(self, solver: SteadyTurn, turn: Turn, start: CarPoint) -> None:
        self.turn = turn
        self._solver, self._start = solver, start
        self._unknowns = start.unknowns

    def evaluate(self, x: Vector) -> tuple[Vector, Vector]:
        """Return residual and Jacobian, this by differences: the root does not depend on it."""
        residual, self._unknowns = self._at(x)
        columns = []
        for k, value in enumerate(x):
            step = _STEP * max(1.0, abs(float(value)))
            other = x.copy()
            other[k] += step
            columns.append((self._at(other)[0] - residual) / step)
        return residual, np.stack(columns, axis=1)

    def evaluate_along(
        self, turn: Callable[[float], Turn], x: Vector, normal: Vector, gap: float
    ) -> tuple[Vector, Vector]:
        """Return residual and Jacobian with the value of the turn as last unknown.

        The last residual is ``gap``, the distance from a plane with a normal.
        """
        value = float(x[-1])
        step = _STEP * max(1.0, abs(value))
        if not value > 0.0:
            raise NumericalError("a curve of turns begins at zero")
        self.turn = turn(value + step)
        moved, _ = self._at(x[:-1])
        self.turn = turn(value)
        residual, inner = self.evaluate(x[:-1])
        rows = np.column_stack([inner, (moved - residual) / step])
        return np.append(residual, gap), np.vstack([rows, normal])

    def point(self, x: Vector) -> CarPoint:
        """Return the point of some unknowns."""
        moved = self._solver.moved(self.turn, self._start, x)
        return CarPoint(moved.state, self._at(x)[1], moved.parameters)

    def _at(self, x: Vector) -> tuple[Vector, Vector]:
        moved = self._solver.moved(self.turn, self._start, x)
        car = self._solver.car
        car.kernel.set_parameters(moved.parameters)
        rates, unknowns = car.rates(moved.state, self._unknowns)
        return self._solver.residual(self.turn, moved, rates), unknowns
