"""Derivatives of steady turns of a car by its parameters.

The unknowns ξ of a turn solve R(ξ, p) = 0, so dξ/dp = -(∂R/∂ξ)⁻¹ ∂R/∂p, and a channel y(ξ, p)
moves by ∂y/∂ξ dξ/dp + ∂y/∂p, all along loops that stay closed. What is demanded of the turn stays.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.handling.circle import QUANTITIES, channels_described, described
from vehicledyn.analyses.handling.slow_turn import slope_at_rest, slow_turns
from vehicledyn.analyses.handling.steady_turn import SteadyTurn
from vehicledyn.analyses.handling.tested_car import CarPoint
from vehicledyn.analyses.handling.turn_equations import BRAKE_SCALE, TurnDemand, TurnOf
from vehicledyn.analyses.handling.turn_limit import TurnCorner, TurnLimit
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.derivatives import Derivatives, TotalDerivatives

Vector = NDArray[np.float64]

_ASIDE = 1e-40
"""Step into the complex plane, so small that its square is nothing."""

_SPEED, _GAIN = "speed", "test.integral_gain"

_UNDERSTEER, _SMALLEST_LOAD = "understeer_angle", "smallest_wheel_load"

_ALIKE = 1e-7
"""Part of wheel loads, and of their derivatives, within which they are one."""

TURNED = tuple(name for name in QUANTITIES if name != _UNDERSTEER)
"""Quantities of a turn by itself; the understeer angle needs the effective wheelbase, too."""


@dataclass(frozen=True)
class TurnMoves:
    """How a turn follows the car's parameters, and derivatives of the car there.

    ``state`` (n_states, n_own) and ``parameters`` (n_parameters, n_own) are derivatives of its
    states and of all parameters of its equations by the car's own.
    """

    total: TotalDerivatives
    state: Vector
    parameters: Vector

    @property
    def outputs(self) -> Vector:
        """Derivatives of the channels that quantities need, (n_needed, n_own)."""
        by_state = self.total.outputs @ self.state
        return np.asarray(by_state + self.total.outputs_by_parameter @ self.parameters)


class TurnSlopes:
    """Quantities of steady turns with their derivatives by the parameters of the car.

    Attributes
    ----------
    parameters
        Numbers of the car's own parameters among those of its equations.
    """

    def __init__(self, solver: SteadyTurn) -> None:
        self.solver, car = solver, solver.car
        e, own = car.equations, {p.name for p in build_subject(car.target).system.table.entries}
        self.parameters = [
            k for k, p in enumerate(e.parameters) if p.name in own and p.name != _SPEED
        ]
        self._needed = channels_described(car)
        rows = [car.channel[name] for name in self._needed]
        less = replace(e, output=e.output[rows], channels=tuple(e.channels[k] for k in rows))
        self._names = [p.name for p in e.parameters]
        self._derivatives = Derivatives(less, self._names)
        self._angle = car.table_places("test.steering.angle")
        self._brake = car.table_places("test.brake_torque")

    def at(self, turn: TurnDemand, point: CarPoint, *, asked: Vector | None = None) -> Vector:
        """Return the quantities of a turn and their derivatives, without understeer angle.

        Parameters
        ----------
        turn, point
            A turn.
        asked
            Derivatives of the value that is demanded of it by the car's parameters, of shape
            (n_parameters,); None if it stays.

        Returns
        -------
        Vector
            Quantities as in ``TURNED``, then a row for each of the car's parameters,
            (1 + n_parameters, n).

        Raises
        ------
        NumericalError
            If the turn is at a limit, where it does not follow the parameters.
        """
        car = self.solver.car
        outputs = car.outputs(point)
        rows = [described(car, outputs)]
        moved = self.moves(turn, point, asked=asked).outputs
        for column in moved.T:
            step = zip(self._needed, column, strict=True)
            rows.append(described(car, {n: complex(outputs[n], _ASIDE * d) for n, d in step}))
        numbers = np.array([[row[name] for name in TURNED] for row in rows])
        found = np.vstack([numbers[:1].real, numbers[1:].imag / _ASIDE])
        found[1:, TURNED.index(_SMALLEST_LOAD)] += self._loads_apart(outputs, moved)
        return found

    def _loads_apart(self, outputs: Mapping[str, float], moved: Vector) -> Vector:
        """Return zeros, but no numbers where two smallest loads of wheels move otherwise."""
        loads = [f"{corner.name}.tyre.normal_force" for corner in self.solver.car.vehicle.corners]
        least = min(outputs[name] for name in loads)
        near = [n for n in loads if abs(outputs[n] - least) <= _ALIKE * max(1.0, abs(least))]
        rows = moved[[self._needed.index(name) for name in near]]
        size = np.abs(rows).max(axis=0)
        return np.where(np.ptp(rows, axis=0) <= _ALIKE * np.maximum(size, 1.0), 0.0, np.nan)

    def quantity(
        self, name: str, turn: TurnDemand, point: CarPoint, *, asked: Vector | None = None
    ) -> Vector:
        """Return a quantity of a turn and its derivatives, (1 + n_parameters,)."""
        return self.named(name, self.at(turn, point, asked=asked))

    def named(self, name: str, quantities: Vector) -> Vector:
        """Return a quantity and its derivatives from what :meth:`at` gives."""
        if name == _UNDERSTEER:
            return self._understeer(quantities)
        return quantities[:, TURNED.index(name)]

    def yaw_acceleration(self, turn: TurnDemand, point: CarPoint) -> Vector:
        """Return the yaw acceleration of a car that is held, and its derivatives [rad/s²]."""
        moves, row = self.moves(turn, point), self.solver.states.motion[2]
        slope = moves.total.rates[row] @ moves.state
        slope += moves.total.rates_by_parameter[row] @ moves.parameters
        return np.append(self.solver.yaw_acceleration(point), slope)

    def _understeer(self, quantities: Vector) -> Vector:
        """Return the understeer angle from what :meth:`at` gives, (1 + n_parameters,)."""
        (ratio, by_ratio), base = self._ratio, self._wheelbase
        angle, bend = (quantities[:, TURNED.index(n)] for n in ("steering_angle", "curvature"))
        found = angle / ratio - base * bend[0]
        found[0] = angle[0] / ratio - base[0] * bend[0]
        found[1:] -= angle[0] / ratio**2 * by_ratio + base[0] * bend[1:]
        return np.asarray(found)

    @cached_property
    def _ratio(self) -> tuple[float, Vector]:
        """Steering ratio, and its derivatives by the car's parameters."""
        car = self.solver.car
        return car.steering_ratio, self._by_own(
            car.vehicle.worth_slopes(car.vehicle.steering_ratio)
        )

    @cached_property
    def _wheelbase(self) -> Vector:
        """Effective wheelbase, then its derivatives by the car's parameters [m]."""
        place = TURNED.index("steering_angle")
        turns = [self.at(turn, point)[:, place] for turn, point in slow_turns(self.solver)]
        slope = slope_at_rest(np.array(turns))
        ratio, by_ratio = self._ratio
        slope[1:] -= slope[0] * by_ratio / ratio
        return np.asarray(slope / ratio)

    def _by_own(self, slopes: dict[str, float]) -> Vector:
        return np.array([slopes.get(self._names[k], 0.0) for k in self.parameters])

    def moves(
        self,
        turn: TurnDemand,
        point: CarPoint,
        *,
        asked: Vector | None = None,
        gains: Mapping[str, Vector] | None = None,
    ) -> TurnMoves:
        """Return how a turn follows the car's parameters.

        ``gains`` holds derivatives of further parameters by the car's own.

        Raises
        ------
        NumericalError
            If the turn is at a limit, where it does not follow the parameters.
        """
        solver, car, s = self.solver, self.solver.car, self.solver.states
        given = self._given(point, gains or {})
        unknowns = solver.unknowns(turn, point)
        rows = solver.search(turn, point).evaluate(unknowns)[1]
        total, state, share = self._parts(point, unknowns, given)
        pushed = self._pushed(turn, total, state, given)
        if asked is not None:
            pushed[-1] -= asked
        try:
            follow = -np.linalg.solve(rows, pushed)
        except np.linalg.LinAlgError:
            raise NumericalError("the turn is at a limit, where it has no derivative") from None
        braked = point.parameters[self._brake[0]]
        drive = np.zeros_like(follow[-1]) if braked else follow[-1]
        state[s.free] = follow[:-2]
        state[s.integral] += share * drive
        if s.pedal is not None:
            state[s.pedal] = drive
        given[car.place(_SPEED)] = state[s.motion[0]]
        given[self._angle] = follow[-2]
        if braked:
            given[self._brake] = -BRAKE_SCALE * follow[-1]
        return TurnMoves(total, state, given)

    def limit(self, turn: TurnOf, found: TurnLimit | TurnCorner) -> Vector:
        """Return the value of a limit, then its derivatives, (1 + n_parameters,).

        Raises
        ------
        NumericalError
            If the limit is where two corners meet.
        """

        def pushed(value: float, point: CarPoint) -> Vector:
            wanted = turn(value)
            unknowns, given = self.solver.unknowns(wanted, point), self._given(point, {})
            total, state, _ = self._parts(point, unknowns, given)
            return self._pushed(wanted, total, state, given)

        if isinstance(found, TurnLimit):
            slopes = -found.row @ pushed(found.value, found.point)
        else:
            values = [self.solver.car.equations.parameters[k].value for k in self.parameters]
            slopes = found.slopes(pushed, np.array([abs(value) or 1.0 for value in values]))
        return np.append(found.value, slopes)

    def _given(self, point: CarPoint, gains: Mapping[str, Vector]) -> Vector:
        """Return how all parameters follow the car's own, those of the turn aside."""
        own, car = self.parameters, self.solver.car
        given = np.zeros((len(point.parameters), len(own)))
        given[own] = np.eye(len(own))
        for name, slopes in gains.items():
            given[car.place(name)] = slopes
        return given

    def _parts(
        self, point: CarPoint, unknowns: Vector, given: Vector
    ) -> tuple[TotalDerivatives, Vector, float]:
        """Return derivatives at a turn, those of states that no unknown is, and a share.

        The share is what the controller's integral moves by with the drive among the unknowns.
        """
        car, s, own = self.solver.car, self.solver.states, self.parameters
        total = self._derivatives.total(0.0, point.state, point.unknowns, point.parameters)
        state = np.zeros((len(point.state), len(own)))
        share = 1.0
        if s.pedal is not None and car.vehicle.throttle is not None:
            torque, place = car.vehicle.throttle.torque, car.place(_GAIN)
            gain = point.parameters[place]
            share, pressed = car.worth(torque) / gain, point.state[s.pedal]
            by_full = self._by_own(car.vehicle.worth_slopes(torque))
            state[s.integral] = pressed * (by_full - share * given[place]) / gain
        return total, state, share

    def _pushed(
        self, turn: TurnDemand, total: TotalDerivatives, state: Vector, given: Vector
    ) -> Vector:
        """Return the derivatives of what is unbalanced by the car's parameters, (size, n)."""
        states = self.solver.states
        balanced = states.balanced
        pushed = total.rates_by_parameter[balanced] @ given + total.rates[balanced] @ state
        if turn.sideslip is not None:
            pushed[balanced.index(states.motion[2])] = 0.0
        return np.vstack([pushed, np.zeros((2, pushed.shape[1]))])
