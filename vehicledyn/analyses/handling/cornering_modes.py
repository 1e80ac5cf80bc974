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

_STEERING = "test.steering"
_KNOTS = {f"{_STEERING}.angle.time_0": -0.5, f"{_STEERING}.angle.time_1": 0.5}
"""Times of two knots about the present one: at a knot itself a slope is the mean of both [s]."""

_SINE = {
    "amplitude": 0.0,
    "frequency": 0.5 / np.pi,
    "sweep_rate": 0.0,
    "cycles": 1.0,
    "hold_at": 10.0,
    "dwell": 0.0,
    "begin": -0.5 * np.pi,
}
"""A sine of 1 rad/s at its peak: its amplitude is an angle δ with the acceleration -δ [SI]."""

INPUTS = [f"{_STEERING}.{name}" for name in ("angle.value_0", "angle.value_1", "amplitude")]
"""Knots before and behind, and the amplitude of the sine."""


@dataclass(frozen=True)
class CorneringSystem:
    """ẋ = A x + B_0 δ + B_1 δ̇ + B_2 δ̈ and y = C x + D_0 δ + D_1 δ̇ + D_2 δ̈ about a steady turn.

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
            steering = np.array([1.0, s, s * s])
            moved = np.linalg.solve(s * unit - self.matrix, self.inputs @ steering)
            found.append(shown @ moved + direct @ steering)
        return np.array(found)


class CorneringModes:
    """Linearises a car about its steady turns, with exact derivatives.

    Attributes
    ----------
    kept
        Indices of the states that are kept.
    motion
        Numbers among them of the velocities along x and y and of the yaw rate.
    inputs
        Indices of the parameters that steer, see :data:`INPUTS`.
    """

    def __init__(self, solver: SteadyTurn) -> None:
        car = self.car = solver.car
        e, chassis = car.equations, car.vehicle.chassis
        left_out = {f"{chassis}.x", f"{chassis}.y", f"{chassis}.yaw", *solver.states.turning}
        self.kept = [k for k, s in enumerate(e.states) if s.name not in left_out]
        names = [e.states[k].name for k in self.kept]
        self.motion = [names.index(f"{chassis}.{n}_rate") for n in ("x", "y", "yaw")]
        self._names = names
        self.inputs = [car.place(name) for name in INPUTS]
        self._slopes = Derivatives(e, INPUTS)

    def about(self, point: CarPoint, *, held_speed: bool = False) -> CorneringSystem:
        """Return the linear system about a turn.

        ``held_speed`` keeps the torque and integral of the speed controller as further motion; by
        itself the drive torque is that of the turn, constant.
        """
        car, parameters = self.car, self.parameters(point)
        if not held_speed:
            gain = parameters[car.place("test.integral_gain")]
            integral = point.state[car.state("drive.speed_error_integral")]
            torques = car.table_places("test.drive_torque")
            parameters[torques] += gain * integral
            for name in ("test.integral_gain", "test.proportional_gain"):
                parameters[car.place(name)] = 0.0
        found = self._slopes.total(0.0, point.state, point.unknowns, parameters)
        matrix = found.rates[np.ix_(self.kept, self.kept)].copy()
        ahead, aside, yaw = self.motion
        state = point.state[self.kept]
        matrix[ahead, aside] += state[yaw]
        matrix[ahead, yaw] += state[aside]
        matrix[aside, ahead] -= state[yaw]
        matrix[aside, yaw] -= state[ahead]
        inputs = self._inputs(found.rates_by_parameter[self.kept])
        if not held_speed:
            kept = [k for k, n in enumerate(self._names) if n != "drive.speed_error_integral"]
            matrix, inputs = matrix[np.ix_(kept, kept)], inputs[kept]
        else:
            kept = list(range(len(self._names)))
        direct = self._inputs(found.outputs_by_parameter)
        columns = [self.kept[k] for k in kept]
        outputs = {name: (found.outputs[k][columns], direct[k]) for name, k in car.channel.items()}
        return CorneringSystem([self._names[k] for k in kept], matrix, inputs, outputs)

    def parameters(self, point: CarPoint) -> Vector:
        """Return the parameters of a turn, with the knots and the sine that make its inputs."""
        parameters = point.parameters.copy()
        sine = {f"{_STEERING}.{name}": value for name, value in _SINE.items()}
        for name, value in {**_KNOTS, **sine}.items():
            parameters[self.car.place(name)] = value
        return parameters

    @staticmethod
    def _inputs(by_parameter: Vector) -> Vector:
        """Return the columns by angle, rate and acceleration from those by knots and amplitude."""
        before, after, at_peak = by_parameter.T
        angle = before + after
        return np.stack([angle, 0.5 * (after - before), angle - at_peak], axis=1)
