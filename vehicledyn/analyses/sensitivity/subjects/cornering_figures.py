"""Derivatives of the linear system about steady turns: yaw responses and eigenvalues.

With S = [A B; C D] the response is H = c φ + d, φ = (s I - A)⁻¹ b, and moves by dH = (ψ, 1) dS
(φ, 1), ψ = c (s I - A)⁻¹; an eigenvalue by l dA r / (l r).
"""

from __future__ import annotations

from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.eigenvalues import LinearPoint
from vehicledyn.analyse.gradients.linear_system import (
    Following,
    LinearisedSlopes,
    SystemDerivatives,
)
from vehicledyn.analyses.handling.circle import at_speed
from vehicledyn.analyses.handling.cornering_modes import CorneringModes
from vehicledyn.analyses.handling.response_sheets import ANSWERS
from vehicledyn.analyses.handling.steady_turn import DRIVEN_BY, INTEGRAL_SHARE, drive_turns
from vehicledyn.analyses.handling.tested_car import CarPoint
from vehicledyn.analyses.handling.turn_equations import TurnDemand
from vehicledyn.analyses.handling.turn_slopes import TurnMoves, TurnSlopes
from vehicledyn.analyses.sensitivity.mode_figures import mode_figures
from vehicledyn.analyses.sensitivity.subjects.steady_curves import Found, traced
from vehicledyn.analyses.sensitivity.subjects.steady_names import PHASE, Asked
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.units import shown
from vehicledyn.results.store.linear_file import Quantity

Floats = NDArray[np.float64]
Complex = NDArray[np.complex128]

_ALIKE = 1e-8
"""Part of the longest distance of eigenvalues within which two are one [1]."""


class CorneringSlopes:
    """The linear system of a car about its turns, with derivatives by the car's parameters."""

    def __init__(self, slopes: TurnSlopes) -> None:
        self._slopes, car = slopes, slopes.solver.car
        self.modes = CorneringModes(slopes.solver)
        channels = [car.channel[channel] for _, _, channel in ANSWERS.values()]
        self._derivatives = SystemDerivatives(car.equations, self.modes.inputs, channels)

    @cached_property
    def _gains(self) -> dict[str, Floats]:
        """How the gains of the speed controller follow the car's parameters."""
        turns = drive_turns(self._slopes.solver)
        held, driven = (self._slopes.quantity("drive_torque", *found) for found in turns)
        gain = (driven - held)[1:] * np.sign(driven[0] - held[0]) / DRIVEN_BY
        return {"test.proportional_gain": gain, "test.integral_gain": INTEGRAL_SHARE * gain}

    def about(self, turn: TurnDemand, point: CarPoint) -> LinearTurn:
        """Return the linear system about a turn."""
        moves = self._slopes.moves(turn, point, gains=self._gains)
        given = self.modes.parameters(point)
        by_held = np.zeros((len(point.state), len(given)))
        by_held[:, self._slopes.parameters] = moves.state
        linear = LinearPoint(given, 0.0, point.state, point.unknowns)
        system = self._derivatives.at(linear, Following((), by_held))
        return LinearTurn(self.modes, system, moves, point)


class LinearTurn:
    """The linear system about a turn: rates and answers by kept states and the three inputs."""

    def __init__(
        self, modes: CorneringModes, system: LinearisedSlopes, moves: TurnMoves, point: CarPoint
    ) -> None:
        self._system, self._moves = system, moves
        n = system.n_states
        self._kept, (ahead, aside, yaw) = modes.kept, modes.motion
        self._turning = [
            (row, *places, sign)
            for row, other, sign in ((ahead, aside, 1.0), (aside, ahead, -1.0))
            for places in ((other, yaw), (yaw, other))
        ]
        kept = [*self._kept, *range(n, len(system.matrix))]
        columns = [*self._kept, *range(n, system.matrix.shape[1])]
        self.matrix: Floats = system.matrix[np.ix_(kept, columns)].copy()
        for row, column, state, sign in self._turning:
            self.matrix[row, column] += sign * point.state[self._kept[state]]

    @property
    def size(self) -> int:
        """Number of states that are kept."""
        return len(self._kept)

    def slope(self, left: Complex, right: Complex) -> Complex:
        """Return the derivative of left S right by the car's parameters, (n_own,)."""
        n, size = self._system.n_states, self.size
        rows = np.zeros(len(self._system.matrix), dtype=complex)
        columns = np.zeros(self._system.matrix.shape[1], dtype=complex)
        rows[self._kept], rows[n:] = left[:size], left[size:]
        columns[self._kept], columns[n:] = right[:size], right[size:]
        found = self._system.slope(rows, columns) @ self._moves.parameters
        for row, column, state, sign in self._turning:
            found += sign * left[row] * right[column] * self._moves.state[self._kept[state]]
        return np.asarray(found)

    def response(self, answer: int, frequency: float) -> tuple[complex, Complex]:
        """Return an answer over steering-wheel angle at a frequency [Hz], and its derivatives."""
        size, s = self.size, 2j * np.pi * frequency
        steering = np.array([1.0 - 0.5 * s + s * s, 1.0 + 0.5 * s + s * s, -s * s])
        shifted = s * np.eye(size) - self.matrix[:size, :size]
        shown_by, direct = self.matrix[size + answer, :size], self.matrix[size + answer, size:]
        try:
            motion = np.linalg.solve(shifted, self.matrix[:size, size:] @ steering)
            left = np.linalg.solve(shifted.T, shown_by.astype(complex))
        except np.linalg.LinAlgError:
            raise NumericalError(f"{frequency:g} Hz is an undamped mode's frequency") from None
        unit = np.eye(len(self.matrix) - size)[answer]
        value = complex(shown_by @ motion + direct @ steering)
        slope = self.slope(np.concatenate([left, unit]), np.concatenate([motion, steering]))
        return value, slope

    def eigenvalues(self) -> list[tuple[complex, Complex]]:
        """Return the modes, slowest first, with derivatives, not a number where two are one."""
        size, zeros = self.size, np.zeros(len(self.matrix) - self.size)
        values, right = np.linalg.eig(self.matrix[:size, :size])
        left = np.linalg.inv(right)
        found: list[tuple[complex, Complex]] = []
        for k in np.argsort(np.abs(values), kind="stable"):
            if values[k].imag < 0.0:
                continue
            apart = np.delete(np.abs(values - values[k]), k).min(initial=np.inf)
            rows = np.concatenate([left[k], zeros])
            slope = self.slope(rows, np.concatenate([right[:, k], np.zeros(_INPUTS)]))
            if apart <= _ALIKE * np.abs(values).max():
                slope = np.full_like(slope, np.nan)
            found.append((complex(values[k]), slope))
        return found


_INPUTS = 3


def response_figures(slopes: TurnSlopes, asked: Asked) -> Found:
    """Yield gains and phases of the yaw response of a car that runs straight."""
    speed = asked.of("speed")
    turn, point = TurnDemand(speed, "steering", 0.0), slopes.solver.straight(speed)
    linear = CorneringSlopes(slopes).about(turn, point)
    is_phase = asked.quantity.endswith(PHASE)
    name = asked.quantity.rpartition("_")[0]
    unit, words, _ = ANSWERS[name]
    text = f"{words} over steering-wheel angle{': phase' if is_phase else ''}"
    for frequency in asked.values:
        value, slope = linear.response(list(ANSWERS).index(name), frequency)
        moved: Any = slope / value
        size = float(np.angle(value)) if is_phase else abs(value)
        part = moved.imag if is_phase else size * moved.real
        about = Quantity(asked.at(frequency), "rad" if is_phase else unit, text)
        yield about, np.append(size, part)


def turn_eigenvalue_figures(slopes: TurnSlopes, asked: Asked) -> Found:
    """Yield growth, frequencies and damping of all modes about turns at constant speed."""
    curve = traced(slopes.solver, asked, max(asked.values))
    lateral, turns = curve.values["lateral_acceleration"], at_speed(asked.of("speed"))
    system = CorneringSlopes(slopes)
    for value in asked.values:
        turn = turns(value)
        near = curve.points[int(np.argmin(np.abs(lateral - value)))]
        point = slopes.solver.find(turn, near)
        for k, (number, slope) in enumerate(system.about(turn, point).eigenvalues()):
            for about, size, part in mode_figures(k + 1, number, slope):
                name = f"{about.name} at {shown(value, 'm/s^2')}, {asked.where}"
                yield Quantity(name, about.unit, about.description), np.append(size, part)
