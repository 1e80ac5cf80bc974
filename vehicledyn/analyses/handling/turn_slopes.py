"""Derivatives of steady turns of a car by its parameters.

The unknowns ξ of a turn solve R(ξ, p) = 0, so dξ/dp = -(∂R/∂ξ)⁻¹ ∂R/∂p, and a channel y(ξ, p)
moves by ∂y/∂ξ dξ/dp + ∂y/∂p, all along loops that stay closed. What is demanded of the turn stays.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.handling.circle import QUANTITIES, channels_described, described
from vehicledyn.analyses.handling.slow_turn import slope_at_rest, slow_turns
from vehicledyn.analyses.handling.steady_turn import SteadyTurn
from vehicledyn.analyses.handling.tested_car import CarPoint
from vehicledyn.analyses.handling.turn_equations import Turn, TurnOf
from vehicledyn.analyses.handling.turn_limit import TurnLimit
from vehicledyn.analyses.preparation.build_model import build_subject
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.derivatives import Derivatives, TotalDerivatives

Vector = NDArray[np.float64]

_ASIDE = 1e-40
"""Step into the complex plane, so small that its square is nothing."""

_SPEED = "speed"

_UNDERSTEER = "understeer_angle"
TURNED = tuple(name for name in QUANTITIES if name != _UNDERSTEER)
"""Quantities of a turn by itself; the understeer angle needs the effective wheelbase, too."""


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

    def at(self, turn: Turn, point: CarPoint) -> Vector:
        """Return the quantities of a turn and their derivatives, without understeer angle.

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
        moved = self._moved(turn, point)
        rows = [described(car, outputs)]
        for column in moved.T:
            step = zip(self._needed, column, strict=True)
            rows.append(described(car, {n: complex(outputs[n], _ASIDE * d) for n, d in step}))
        found = np.array([[row[name] for name in TURNED] for row in rows])
        return np.vstack([found[:1].real, found[1:].imag / _ASIDE])

    def quantity(self, name: str, turn: Turn, point: CarPoint) -> Vector:
        """Return a quantity of a turn and its derivatives, (1 + n_parameters,)."""
        found = self.at(turn, point)
        return self._understeer(found) if name == _UNDERSTEER else found[:, TURNED.index(name)]

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

    def _moved(self, turn: Turn, point: CarPoint) -> Vector:
        """Return the derivatives of the channels that are needed, (n_needed, n_parameters)."""
        solver, car = self.solver, self.solver.car
        s, own = solver.states, self.parameters
        unknowns = solver.unknowns(turn, point)
        rows = solver.search(turn, point).evaluate(unknowns)[1]
        total, state, share = self._parts(point, unknowns)
        pushed = self._pushed(total, state, len(unknowns))
        try:
            follow = -np.linalg.solve(rows, pushed)
        except np.linalg.LinAlgError:
            raise NumericalError("the turn is at a limit, where it has no derivative") from None
        state[s.free] = follow[:-2]
        state[s.integral] += share * follow[-1]
        if s.pedal is not None:
            state[s.pedal] = follow[-1]
        parameters = np.zeros((len(point.parameters), len(own)))
        parameters[own] = np.eye(len(own))
        parameters[car.place(_SPEED)] = state[s.motion[0]]
        parameters[self._angle] = follow[-2]
        return np.asarray(total.outputs @ state + total.outputs_by_parameter @ parameters)

    def limit(self, turn: TurnOf, found: TurnLimit) -> Vector:
        """Return the value of a limit, then its derivatives, (1 + n_parameters,)."""
        unknowns = self.solver.unknowns(turn(found.value), found.point)
        total, state, _ = self._parts(found.point, unknowns)
        pushed = self._pushed(total, state, len(unknowns))
        return np.concatenate([[found.value], -found.row @ pushed])

    def _parts(self, point: CarPoint, unknowns: Vector) -> tuple[TotalDerivatives, Vector, float]:
        """Return derivatives at a turn, those of states that no unknown is, and a share.

        The share is what the controller's integral moves by with the drive among the unknowns.
        """
        car, s, own = self.solver.car, self.solver.states, self.parameters
        total = self._derivatives.total(0.0, point.state, point.unknowns, point.parameters)
        state = np.zeros((len(point.state), len(own)))
        share = 1.0
        if s.pedal is not None and car.vehicle.throttle is not None:
            torque = car.vehicle.throttle.torque
            gain = point.parameters[car.place("test.integral_gain")]
            share = car.worth(torque) / gain
            by_full = self._by_own(car.vehicle.worth_slopes(torque))
            state[s.integral] = unknowns[-1] * by_full / gain
        return total, state, share

    def _pushed(self, total: TotalDerivatives, state: Vector, size: int) -> Vector:
        """Return the derivatives of what is unbalanced by the car's parameters, (size, n)."""
        balanced, own = self.solver.states.balanced, self.parameters
        pushed = np.zeros((size, len(own)))
        by_parameter = total.rates_by_parameter[np.ix_(balanced, own)]
        pushed[: len(balanced)] = by_parameter + total.rates[balanced] @ state
        return pushed
