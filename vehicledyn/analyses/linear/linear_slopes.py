"""Derivatives of a linearised model with inputs by its parameters, and of its responses."""

from __future__ import annotations

import cmath
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.linear_system import LinearisedSlopes, SystemDerivatives
from vehicledyn.analyse.gradients.state_space_slopes import StateSpaceSlopes, proper_slopes
from vehicledyn.analyses.linear.input_names import InputPart
from vehicledyn.analyses.linear.linear_inputs import PREFIX
from vehicledyn.analyses.linear.reference_motion import ReferenceMotion
from vehicledyn.analyses.linear.response import Linearised, transfer_system
from vehicledyn.base.errors import NumericalError
from vehicledyn.files.scenario.target import Target
from vehicledyn.symbolic import ops

Floats = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class InputSlopes:
    """A linearised model with inputs, ready to be differentiated; ``rows`` are its channels."""

    model: Linearised
    rows: tuple[int, ...]
    system: LinearisedSlopes

    @property
    def parameters(self) -> list[int]:
        """Numbers of the parameters that are the model's own."""
        names = [p.name for p in self.model.prepared.equations.parameters]
        return [k for k, name in enumerate(names) if not name.startswith(f"{PREFIX}.")]

    def response(self, which: int, row: int, frequency: complex) -> tuple[complex, Complex]:
        """Return a frequency response and its derivative by all parameters.

        H = Σ g e^{-s τ} (c (s I - A)⁻¹ Σ sᵏ B_k + Σ sᵏ D_k),    s = 2π i f

        Parameters
        ----------
        which, row
            Number of the input, and of the output among ``rows``.
        frequency
            f, above zero [Hz]; complex to differentiate by it.

        Raises
        ------
        NumericalError
            If the frequency is that of an undamped mode.
        """
        s = 2j * np.pi * frequency
        system, n = self.system, self.system.n_states
        weights = np.zeros(len(self.model.columns), dtype=complex)
        moved = np.zeros((len(weights), system.outputs.shape[1]), dtype=complex)
        terms = transfer_system(self.model, self.rows).inputs[which]
        for part, term in zip(self.model.inputs[which].parts, terms, strict=True):
            gain, late = self.gain_slope(part), self._delay_slope(part)
            for power, name in enumerate(part.parameters):
                column = self.model.columns[name]
                effects = cmath.exp(-s * term.delay) * s**power
                weights[column] += term.factor * effects
                moved[column] += effects * (gain - s * term.factor * late)
        a, b = system.matrix[:n, :n], system.matrix[:n, n:]
        output = system.matrix[n + row]
        shifted = s * np.eye(n) - a
        try:
            motion = np.linalg.solve(shifted, b @ weights)
            left = np.linalg.solve(shifted.T, output[:n].astype(complex))
        except np.linalg.LinAlgError:
            raise NumericalError(f"{frequency:g} Hz is an undamped mode's frequency") from None
        unit = np.zeros(len(system.matrix) - n, dtype=complex)
        unit[row] = 1.0
        by_weight = left @ b + output[n:]
        value = complex(output[:n] @ motion + output[n:] @ weights)
        slope = system.slope(np.concatenate([left, unit]), np.concatenate([motion, weights]))
        return value, slope + by_weight @ moved

    def gain_slope(self, part: InputPart) -> Floats:
        """Return the derivative of an input's gain by all parameters."""
        subject = self.model.prepared.subject
        symbols = ops.column([entry.symbol for entry in subject.system.table.entries])
        slope = ops.jacobian(ops.column([ops.scalar(part.gain)]), symbols)
        found = ops.numeric([symbols], slope)(self.model.prepared.kernel.parameters)
        return np.asarray(found, dtype=float).ravel()

    def _delay_slope(self, part: InputPart) -> Floats:
        """Return the derivative of the delay of a wheel behind the foremost one."""
        e, speed = self.model.prepared.equations, self.model.speed
        if not part.wheel:
            return np.zeros(len(e.parameters))
        wheels = list(dict.fromkeys(p.wheel for i in self.model.inputs for p in i.parts if p.wheel))
        places = self.model.prepared.kernel.outputs(
            self.model.prepared.subject.balance_time,
            self.model.point.state,
            self.model.point.unknowns,
        )
        numbers = {w: self._channel(f"{w}.contact_x") for w in wheels}
        first = max(wheels, key=lambda w: places[numbers[w]])
        offset = len(self.rows)
        rows = {w: self.system.outputs[offset + k] for k, w in enumerate(wheels)}
        slope = (rows[first] - rows[part.wheel]) / speed
        names = [p.name for p in e.parameters]
        if "speed" in names:
            apart = float(places[numbers[first]] - places[numbers[part.wheel]])
            slope = slope.copy()
            slope[names.index("speed")] -= apart / speed**2
        return np.asarray(slope, dtype=float)

    def _channel(self, name: str) -> int:
        channels = self.model.prepared.equations.channels
        return [c.name for c in channels].index(name)


def differentiable(model: Linearised, rows: Sequence[int], target: Target) -> InputSlopes:
    """Return a linearised model with inputs, ready to be differentiated.

    Parameters
    ----------
    model
        The model.
    rows
        Numbers of the channels that are its outputs.
    target
        Where the model is from.

    Raises
    ------
    InputError
        If the states hold quaternions.
    NumericalError
        If no derivative exists at its reference point.
    """
    e = model.prepared.equations
    names = [p.name for p in e.parameters]
    channels = [c.name for c in e.channels]
    wheels = dict.fromkeys(p.wheel for i in model.inputs for p in i.parts if p.wheel)
    watched = [*rows, *(channels.index(f"{wheel}.contact_x") for wheel in wheels)]
    inputs = [names.index(name) for name in model.columns]
    motion = ReferenceMotion(model.prepared, model.speed, target)
    point, following = motion.at(model.point, model.prepared.kernel.parameters)
    system = SystemDerivatives(e, inputs, watched).at(point, following)
    return InputSlopes(model, tuple(rows), system)


def matrix_slopes(
    slopes: InputSlopes, orders: Sequence[int], chosen: Sequence[int]
) -> StateSpaceSlopes:
    """Return the derivatives of a model in state space by chosen parameters.

    Parameters
    ----------
    slopes
        The model; its inputs act without delay.
    orders
        The order that each input is taken of, see :func:`~vehicledyn.analyse.state_space.proper`.
    chosen
        Numbers of the parameters.
    """
    model, n, n_rows = slopes.model, slopes.system.n_states, len(slopes.rows)
    kept = n + n_rows
    matrix = slopes.system.matrix[:kept]
    moved = np.moveaxis(slopes.system.matrix_slopes()[:kept][:, :, list(chosen)], 2, 0)
    terms = transfer_system(model, slopes.rows).inputs
    values, changes = [], []
    for item, parts in zip(model.inputs, terms, strict=True):
        value, change = np.zeros((3, kept)), np.zeros((len(chosen), 3, kept))
        for part, term in zip(item.parts, parts, strict=True):
            gain = slopes.gain_slope(part)[list(chosen)]
            for power, name in enumerate(part.parameters):
                column = n + model.columns[name]
                value[power] += term.factor * matrix[:, column]
                change[:, power] += term.factor * moved[:, :, column]
                change[:, power] += np.outer(gain, matrix[:, column])
        values.append(value)
        changes.append(change)
    return proper_slopes(matrix[:, :n], moved[:, :, :n], values, changes, orders)
