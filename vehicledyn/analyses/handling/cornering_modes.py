"""Eigenvalues of a car about steady cornering, and its response to the steering wheel there.

In a turn the position and heading of the car grow without end, and nothing depends on them; with
the velocity in axes along the heading (v̇_x = a_x + r v_y, v̇_y = a_y - r v_x) the motion is a
fixed point, about which the equations are linear with constant coefficients.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.handling.steady_turn import SteadyTurn
from vehicledyn.analyses.handling.tested_car import CarPoint
from vehicledyn.kernel.derivatives import Derivatives

Vector = NDArray[np.float64]

_TABLE = "test.steering.angle"
_KNOT_DISTANCE = 1.0


@dataclass(frozen=True)
class CorneringSystem:
    """ẋ = A x + B_0 δ + B_1 δ̇ and y = C x + D_0 δ + D_1 δ̇ about a steady turn.

    ``states`` are the names of x; ``outputs`` those of y; matrices in SI.
    """

    states: list[str]
    matrix: Vector
    inputs: Vector
    outputs: dict[str, tuple[Vector, Vector]]

    @property
    def eigenvalues(self) -> NDArray[np.complex128]:
        """Eigenvalues, slowest first [1/s]."""
        found = np.asarray(np.linalg.eigvals(self.matrix), dtype=complex)
        return found[np.argsort(np.abs(found))]

    def response(self, output: str, frequencies: Vector) -> NDArray[np.complex128]:
        """Return output over steering-wheel angle at frequencies [Hz]."""
        shown, direct = self.outputs[output]
        unit = np.eye(len(self.matrix))
        found = []
        for s in 2j * np.pi * frequencies:
            given = self.inputs[:, 0] + s * self.inputs[:, 1]
            moved = np.linalg.solve(s * unit - self.matrix, given)
            found.append(shown @ moved + direct[0] + s * direct[1])
        return np.array(found)


class CorneringModes:
    """Linearises a car about its steady turns, with exact derivatives."""

    def __init__(self, solver: SteadyTurn) -> None:
        car = self.car = solver.car
        e, chassis = car.equations, car.vehicle.chassis
        left_out = {f"{chassis}.x", f"{chassis}.y", f"{chassis}.yaw", *solver.states.turning}
        self._kept = [k for k, s in enumerate(e.states) if s.name not in left_out]
        names = [e.states[k].name for k in self._kept]
        self._motion = [names.index(f"{chassis}.{n}_rate") for n in ("x", "y", "yaw")]
        self._names = names
        self._slopes = Derivatives(e, [f"{_TABLE}.value_0", f"{_TABLE}.value_1"])

    def about(self, point: CarPoint, *, held_speed: bool = False) -> CorneringSystem:
        """Return the linear system about a turn.

        ``held_speed`` keeps the torque and integral of the speed controller as further motion; by
        itself the drive torque is that of the turn, constant.
        """
        car = self.car
        parameters = point.parameters.copy()
        times = [car.place(f"{_TABLE}.time_{k}") for k in (0, 1)]
        parameters[times] = [0.0, _KNOT_DISTANCE]
        if not held_speed:
            gain = parameters[car.place("test.integral_gain")]
            integral = point.state[car.state("drive.speed_error_integral")]
            torques = car.table_places("test.drive_torque")
            parameters[torques] += gain * integral
            for name in ("test.integral_gain", "test.proportional_gain"):
                parameters[car.place(name)] = 0.0
        found = self._slopes.total(0.0, point.state, point.unknowns, parameters)
        matrix = found.rates[np.ix_(self._kept, self._kept)].copy()
        ahead, aside, yaw = self._motion
        state = point.state[self._kept]
        matrix[ahead, aside] += state[yaw]
        matrix[ahead, yaw] += state[aside]
        matrix[aside, ahead] -= state[yaw]
        matrix[aside, yaw] -= state[ahead]
        inputs = self._inputs(found.rates_by_parameter[self._kept])
        if not held_speed:
            kept = [k for k, n in enumerate(self._names) if n != "drive.speed_error_integral"]
            matrix, inputs = matrix[np.ix_(kept, kept)], inputs[kept]
        else:
            kept = list(range(len(self._names)))
        direct = self._inputs(found.outputs_by_parameter)
        columns = [self._kept[k] for k in kept]
        outputs = {name: (found.outputs[k][columns], direct[k]) for name, k in car.channel.items()}
        return CorneringSystem([self._names[k] for k in kept], matrix, inputs, outputs)

    @staticmethod
    def _inputs(by_knots: Vector) -> Vector:
        """Return the columns by angle and rate from those by the first two knots."""
        rate = _KNOT_DISTANCE * by_knots[:, 1]
        return np.stack([by_knots.sum(axis=1), rate], axis=1)
