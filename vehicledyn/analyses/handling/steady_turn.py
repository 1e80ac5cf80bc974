"""Steady cornering without time simulation: states that turn about the vertical unchanged.

In a steady turn the chassis keeps height, pitch and roll, all springs keep their length, and the
velocity turns with the yaw rate. Newton's method balances accelerations, wheel spins and further
states of a car in this motion, see :mod:`vehicledyn.analyses.handling.turn_equations`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.newton import solve_damped
from vehicledyn.analyses.handling.switches import Switches
from vehicledyn.analyses.handling.tested_car import CarPoint, TestedCar
from vehicledyn.analyses.handling.turn_equations import TurnDemand, TurnEquations, TurnOf
from vehicledyn.analyses.handling.turn_states import TurnStates
from vehicledyn.base.errors import NumericalError
from vehicledyn.road.manoeuvres.speed_control import SpeedControl

Vector = NDArray[np.float64]

BALANCED = 1e-7
"""Largest acceleration that counts as balanced [m/s², rad/s²]."""

ITERATIONS = 15

_SHAFT_STEPS = 3
"""Steps towards shafts that turn with their wheels; between them couplings slip or stick."""

_CHANGES = 20
"""Most changes of gear on the way to a steady turn."""

_USUAL_SPEED, DRIVEN_BY = 20.0, 0.5
"""Speed [m/s] and acceleration [m/s²] at which the drive is measured."""

INTEGRAL_SHARE = 0.3
"""Integral gain of the speed controller over the proportional one [1/s]."""

_TOUCH = 0.01
"""Throttle that a search begins with [1]."""

_PRESSED, FULL_THROTTLE = 1.0 + 1e-6, "full throttle"

_SPINNING, POWER_SLIDE = 0.2, "power slide"
"""Longitudinal slip of a driven wheel beyond that of its largest force, in any tyre [1], and what
that is where the driver steers against the turn."""

_TWICE, WHEEL_SPIN = 1.0, "wheel spin"
"""Longitudinal slip of a wheel that turns twice as fast as the ground [1], and what that is: its
force grows no more, and only the driver's foot keeps it from spinning up on and on."""

LEAST_SIZE = 1e-3
"""Least size that an unknown is measured by."""

_PARTS_BEYOND = (2.0, 1.0, 0.3, 0.1, 0.03)
"""How far behind the last turn of a curve the next one is looked for, as parts of the distance of
the last two."""

_MOST_ASIDE = 0.5
"""Part of the way ahead by which the next turn may lie aside of it, so that it is on the curve."""


class SteadyTurn:
    """Finds steady turns of a car, each near a point known before."""

    def __init__(self, car: TestedCar) -> None:
        self.car = car
        self.states = TurnStates(car)
        self._equations = TurnEquations(car, self.states)
        self._switches = Switches(car)

    def straight(self, speed: float) -> CarPoint:
        """Return straight running at a speed [m/s].

        Raises
        ------
        NumericalError
            If there is no such motion.
        """
        car, start = self.car, self.car.standing
        state = start.state.copy()
        state[self.states.motion[0]] = speed
        for corner in car.vehicle.corners:
            state[car.state(f"{corner.spin}_rate")] = speed / corner.radius
        if self.states.pedal is not None:
            state[self.states.pedal] = _TOUCH  # without throttle the torque has a kink
        guess = CarPoint(self._with_shafts(state, start), start.unknowns, start.parameters)
        return self.find(TurnDemand(speed, "steering", 0.0), guess)

    def _with_shafts(self, state: Vector, at: CarPoint) -> Vector:
        """Return a state with the shafts of the driveline turning as its wheels drive them.

        Half shafts and couplings then keep their twist, as well as the shafts' rates allow.
        """
        spins = {self.car.state(f"{corner.spin}_rate") for corner in self.car.vehicle.corners}
        shafts = [k for k in self.states.rolling if k not in spins]
        if not shafts or not self.states.further:
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
        return self.car.rates(state, at.unknowns)[0][self.states.further]

    def find(self, turn: TurnDemand, guess: CarPoint) -> CarPoint:
        """Return the steady turn near a guess, in the gear that the car drives it in.

        Raises
        ------
        NumericalError
            If Newton's method finds none, or if the car changes its gears on and on.
        """
        given = turn, guess
        return self.car.memory.recall_or_raise("turn", given, lambda: self._find(turn, guess))

    def _find(self, turn: TurnDemand, guess: CarPoint) -> CarPoint:
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

    def _balance(self, turn: TurnDemand, guess: CarPoint) -> CarPoint:
        search = self.search(turn, guess)
        found = solve_damped(
            search.evaluate,
            self.unknowns(turn, guess),
            tolerance=BALANCED,
            max_iterations=ITERATIONS,
            persistent=False,
        )
        if not found.solved:
            worst = float(np.abs(found.residual).max())
            has_pedal, drive = self.states.pedal is not None, found.point[-1]
            pressed = has_pedal and turn.acceleration >= 0.0 and drive > 1.0
            raise NumericalError(
                f"no steady turn with {turn.demand.replace('_', ' ')} {turn.value:.6g} at "
                f"{turn.speed:g} m/s: {worst:.2g} m/s^2 stays unbalanced"
                + (" at full throttle" if pressed else "")
            )
        if self.states.pedal is not None and found.point[-1] < 0.0 <= turn.acceleration:
            raise NumericalError(f"the car gains speed at {turn.speed:g} m/s without throttle")
        return search.point(found.point)

    def beyond(
        self,
        turn: TurnOf,
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
        given = before, last, most, [turn(value) for value in (before[0], last[0], last[0] + most)]
        return self.car.memory.recall(
            "beyond", given, lambda: self._beyond(turn, before, last, most)
        )

    def _beyond(
        self,
        turn: TurnOf,
        before: tuple[float, CarPoint],
        last: tuple[float, CarPoint],
        most: float,
    ) -> tuple[float, CarPoint] | None:
        search = self.search(turn(last[0]), last[1])
        rows = [np.append(self.unknowns(turn(v), point), v) for v, point in (before, last)]
        scale = np.maximum(np.abs(rows).max(axis=0), LEAST_SIZE)
        secant = (rows[1] - rows[0]) / scale
        for way in (search.tangent(turn, rows[1], scale, secant), secant):
            if way is not None:
                highest = last[0] + most
                found = self._beyond_along(search, turn, rows[1], way, scale=scale, highest=highest)
                if found is not None:
                    return found
        return None

    @staticmethod
    def _beyond_along(
        search: TurnSearch,
        turn: TurnOf,
        last: Vector,
        way: Vector,
        *,
        scale: Vector,
        highest: float,
    ) -> tuple[float, CarPoint] | None:
        """Return the next turn and its value by a way in the scale of the unknowns."""
        length = float(np.linalg.norm(way))
        for part in _PARTS_BEYOND:
            ahead = last + part * way * scale

            def evaluate(x: Vector, ahead: Vector = ahead) -> tuple[Vector, Vector]:
                normal = way / length / scale
                return search.evaluate_along(turn, x, normal, float(normal @ (x - ahead)))

            try:
                found = solve_damped(
                    evaluate,
                    ahead,
                    tolerance=BALANCED,
                    max_iterations=ITERATIONS,
                    persistent=False,
                )
            except NumericalError:
                continue  # so far ahead the loops do not close
            aside = float(np.linalg.norm((found.point - ahead) / scale))
            value = float(found.point[-1])
            if found.solved and aside <= _MOST_ASIDE * part * length and value <= highest:
                search.turn = turn(value)
                return value, search.point(found.point[:-1])
        return None

    def search(self, turn: TurnDemand, point: CarPoint) -> TurnSearch:
        """Return the search for a turn that begins at a point."""
        return TurnSearch(self._equations, turn, point)

    def orientation(self, turn: TurnDemand, point: CarPoint) -> int:
        """Return the sign of the Jacobian's determinant, which changes where a curve comes back."""

        def sign() -> int:
            search = self.search(turn, point)
            return int(np.linalg.slogdet(search.evaluate(self.unknowns(turn, point))[1])[0])

        return self.car.memory.recall("orientation", (turn, point), sign)

    def slip_growth(self, turn: TurnDemand, point: CarPoint) -> dict[str, float]:
        """Return how slips grow along a curve of turns with its value, in units of the value.

        They are those of the front wheels across, by the steering angle less the side-slip angle
        (``front``), of the rear ones (``rear``), and of each wheel along, by its corner. At a limit
        one of them runs away: what is held no more.
        """

        def growth() -> list[float]:
            search = self.search(turn, point)
            jacobian = search.evaluate(self.unknowns(turn, point))[1]
            wanted = np.append(np.zeros(len(jacobian) - 1), 1.0)
            way = np.linalg.lstsq(jacobian, wanted, rcond=None)[0]
            places = {k: place for place, k in enumerate(self.states.free)}
            sideslip = float(way[places[self.states.motion[1]]]) / turn.speed
            steering = float(way[-2]) / self.car.steering_ratio
            spins = [
                float(way[places[self.car.state(f"{c.spin}_rate")]]) * c.radius / turn.speed
                for c in self.car.vehicle.corners
            ]
            return [steering - sideslip, sideslip, *spins]

        names = ["front", "rear", *(corner.name for corner in self.car.vehicle.corners)]
        found = self.car.memory.recall("slip growth", (turn, point), growth)
        return dict(zip(names, found, strict=True))

    def beyond_grip_or_drive(self, point: CarPoint) -> str:
        """Return why a left turn is beyond grip or drive, else "".

        As :meth:`beyond_drive`, and where a power slide begins, against which the driver steers.
        """
        outputs = self.car.outputs(point)
        is_slide = outputs["steering_angle.angle"] < 0.0 and self._spin(outputs) > _SPINNING
        drive = self.beyond_drive(point)
        return POWER_SLIDE if is_slide and drive != FULL_THROTTLE else drive

    def beyond_drive(self, point: CarPoint) -> str:
        """Return why a turn is beyond what the drive can hold, else "".

        It needs more than full throttle, or a driven wheel turns twice as fast as the ground.
        """
        pedal = self.states.pedal
        if pedal is not None and point.state[pedal] > _PRESSED:
            return FULL_THROTTLE
        return WHEEL_SPIN if self._spin(self.car.outputs(point)) > _TWICE else ""

    def _spin(self, outputs: dict[str, float]) -> float:
        corners = self.car.vehicle.corners
        return max(outputs[f"{corner.name}.tyre.longitudinal_slip"] for corner in corners)

    def unknowns(self, turn: TurnDemand, point: CarPoint) -> Vector:
        """Return the unknowns of the search for a turn at a point, shape (n_unknowns,)."""
        return self._equations.unknowns(turn, point)

    def yaw_acceleration(self, point: CarPoint) -> float:
        """Return the yaw acceleration at a point [rad/s²]; zero in a steady turn."""
        self.car.kernel.set_parameters(point.parameters)
        return float(self.car.rates(point.state, point.unknowns)[0][self.states.motion[2]])


def solver_for(car: TestedCar) -> SteadyTurn:
    """Return the solver of a car, whose speed controller fits its mass and driveline.

    An error of 1 m/s asks for 1 m/s², and its integral for 0.3 m/s² a second.

    Raises
    ------
    NumericalError
        If the car does not run straight.
    """
    solver = SteadyTurn(car)
    torques = [car.outputs(point)["drive.torque"] for _, point in drive_turns(solver)]
    gain = abs(torques[1] - torques[0]) / DRIVEN_BY
    integral = INTEGRAL_SHARE * gain
    car.hold_speed_by(SpeedControl(proportional_gain=gain, integral_gain=integral))
    return solver


def drive_turns(solver: SteadyTurn) -> list[tuple[TurnDemand, CarPoint]]:
    """Return the motions straight ahead from which the drive of the speed controller is measured.

    One holds its speed, the other gains :data:`DRIVEN_BY`.
    """
    point, found = solver.straight(_USUAL_SPEED), []
    for acceleration in (0.0, DRIVEN_BY):
        turn = TurnDemand(_USUAL_SPEED, "steering", 0.0, acceleration)
        point = solver.find(turn, point) if acceleration else point
        found.append((turn, point))
    return found


class TurnSearch:
    """Residual and Jacobian of the search for one turn; the loops stay closed on the way."""

    def __init__(self, equations: TurnEquations, turn: TurnDemand, start: CarPoint) -> None:
        self.turn = turn
        self._equations, self._point = equations, start

    def evaluate(self, x: Vector) -> tuple[Vector, Vector]:
        """Return residual and Jacobian."""
        residual, jacobian = self._at(x)
        return residual, jacobian[:, : len(x)]

    def evaluate_along(
        self, turn: TurnOf, x: Vector, normal: Vector, gap: float
    ) -> tuple[Vector, Vector]:
        """Return residual and Jacobian with the value of the turn as last unknown.

        The last residual is ``gap``, the distance from a plane with a normal.
        """
        value = float(x[-1])
        if not value > 0.0:
            raise NumericalError("a curve of turns begins at zero")
        self.turn = turn(value)
        residual, jacobian = self._at(x[:-1])
        by_value = self._equations.along(turn, value, jacobian)
        rows = np.column_stack([jacobian[:, : len(x) - 1], by_value])
        return np.append(residual, gap), np.vstack([rows, normal])

    def tangent(self, turn: TurnOf, x: Vector, scale: Vector, way: Vector) -> Vector | None:
        """Return the tangent of the curve at a turn, as long as a way and within 90 deg of it.

        Before a limit the curve bends away from the way to its last turn. None where the curve
        has no tangent, or one across the way.
        """
        length = float(np.linalg.norm(way))
        jacobian = self.evaluate_along(turn, x, way / length / scale, 0.0)[1] * scale
        try:
            along = np.linalg.solve(jacobian, np.append(np.zeros(len(x) - 1), 1.0))
        except np.linalg.LinAlgError:
            return None
        size = float(np.linalg.norm(along))
        return along * (length / size) if np.isfinite(size) else None

    def point(self, x: Vector) -> CarPoint:
        """Return the point of some unknowns."""
        return self._equations.moved(self.turn, self._point, x)

    def _at(self, x: Vector) -> tuple[Vector, Vector]:
        self._point = self.point(x)
        residual, jacobian = self._equations.at(self.turn, self._point, x)
        self._equations.hold_wheels_in_air(self._point, jacobian)
        return residual, jacobian
