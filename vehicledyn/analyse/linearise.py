"""Linearise equations about any point of their motion, loops included."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from vehicledyn.analyse.small_motions import SmallMotions, varied_states
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.derivatives import Derivatives
from vehicledyn.kernel.engine import Vector
from vehicledyn.symbolic.equations import Equations

LARGEST = 1e100
"""Derivative beyond which products of two overflow in the search for eigenvalues."""


@dataclass(frozen=True)
class Linearisation:
    """Small motions about a point: d(δx)/dt = A δx + B δp, δy = C δx + D δp.

    δx are changes of the states, small turns in place of those of quaternions. ``matrix`` A
    (n_varied, n_varied) and ``output_matrix`` C (n_channels, n_varied), with the names of their
    rows; ``input_matrix`` B and ``feedthrough`` D by the parameters that the derivatives were
    made for, and ``unknowns_by_input`` dz/dp (n_unknowns, n_chosen).
    """

    matrix: Vector
    names: tuple[str, ...]
    output_matrix: Vector
    channels: tuple[str, ...]
    input_matrix: Vector
    feedthrough: Vector
    unknowns_by_input: Vector


def linearise(
    equations: Equations,
    parameters: Any,
    time: float,
    state: Any,
    unknowns: Any,
    *,
    derivatives: Derivatives | None = None,
) -> Linearisation:
    """Return the linearisation about a point, with exact derivatives.

    Parameters
    ----------
    equations
        The model.
    parameters
        Values of its parameters, shape (n_parameters,).
    time
        Time [s].
    state, unknowns
        The point; the unknowns must solve the loops.
    derivatives
        Those of the equations, where they are at hand already.

    Raises
    ------
    NumericalError
        If the loops are singular, or derivatives there are no finite numbers or beyond LARGEST.
    """
    derivatives = derivatives or Derivatives(equations)
    point = [np.asarray(item, dtype=float) for item in (state, unknowns, parameters)]
    total = derivatives.total(time, *point)
    too_large = ~(np.abs(total.rates) <= LARGEST)
    if too_large.any():
        row, column = np.argwhere(too_large)[0]
        raise NumericalError(
            f"the derivative of the rate of '{equations.states[row].name}' by "
            f"'{equations.states[column].name}' is {total.rates[row, column]:.3g} at "
            f"t = {time:.9g} s, too large to compute with; check parameters and start values"
        )
    matrix, outputs, inputs = total.rates, total.outputs, total.rates_by_parameter
    if equations.attitudes:
        motions = SmallMotions.at(equations, point[0])
        matrix = motions.reduce @ matrix @ motions.expand + motions.drift
        outputs, inputs = outputs @ motions.expand, motions.reduce @ inputs
    return Linearisation(
        matrix=matrix,
        names=tuple(item.name for item in varied_states(equations)),
        output_matrix=outputs,
        channels=tuple(channel.name for channel in equations.channels),
        input_matrix=inputs,
        feedthrough=total.outputs_by_parameter,
        unknowns_by_input=total.unknowns_by_parameter,
    )
