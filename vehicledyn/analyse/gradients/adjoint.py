"""Derivatives of one figure of a motion by all parameters and start values, by adjoints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.key_figures import FigureSlope
from vehicledyn.base.errors import InputError
from vehicledyn.kernel.back_code import BackCode
from vehicledyn.kernel.engine import Method, Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.tangent_code import Grid, TangentCode

Floats = NDArray[np.float64]

Figure = Callable[[Floats, Floats], tuple[FigureSlope, Floats]]
"""Returns a figure of times (n,) and samples (n, n_channels), and its derivatives by these."""


@dataclass(frozen=True)
class FigureAdjoint:
    """A figure and its derivatives by parameters (n_parameters,) and start states (n_states,).

    ``n_bytes`` is the memory that the motion took on the way back.
    """

    figure: FigureSlope
    by_parameter: Vector
    by_state: Vector
    n_bytes: int


def figure_adjoint(
    code: TangentCode,
    kernel: Kernel,
    grid: Grid,
    *,
    n_intervals: int,
    start: tuple[Vector, Vector],
    figure: Figure,
) -> FigureAdjoint:
    """Return the derivatives of a figure; those of the start state are by all states alone.

    Parameters
    ----------
    code
        Compiled derivatives of the kernel's equations, made with ``back``.
    kernel
        The model with its parameters.
    grid, n_intervals
        The fixed steps, and how many sampling intervals.
    start
        States and unknowns at the start.
    figure
        Draws the figure from the samples of the code's channels.

    Raises
    ------
    InputError
        If the method is not rk4 or the model has events, whose motions are followed forward.
    NumericalError
        If the run cannot go on.
    """
    if grid.method != Method.RK4:
        raise InputError("adjoints are those of rk4; choose solver.kind rk4")
    constants = code.constants(kernel.parameters)
    back = BackCode(code, grid, constants)
    state, guess = start
    unknowns = code.solved(grid.start, state, guess, constants)
    record = back.record(n_intervals, (state, unknowns))
    samples, times = record.samples, record.samples.times
    n_channels = len(code.channels)
    found, seeds = figure(times, back.values(samples)[:, :n_channels])
    padded = np.zeros((len(times), code.n_values))
    padded[:, :n_channels] = seeds
    by_state = back.seeded(samples, padded)
    back.adjoint += by_state[-1]
    back.back(record, by_state)
    slopes = code.constant_slopes(kernel.parameters)
    by_parameter = np.asarray(slopes.T @ back.constants_adjoint)
    return FigureAdjoint(found, by_parameter, back.adjoint.copy(), record.n_bytes)
