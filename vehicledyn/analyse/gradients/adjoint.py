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
from vehicledyn.kernel.tangent_code import Grid, Moment, TangentCode

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
    record, end = back.record(n_intervals * grid.per_interval, (state, unknowns))
    times = np.asarray(grid.start + grid.interval * np.arange(n_intervals + 1), dtype=float)

    def sample(number: int) -> Moment:
        if number == n_intervals:
            return Moment(float(times[number]), end.state, end.unknowns, constants)
        x, z = back.points(record, number * grid.per_interval, 1)
        return Moment(float(times[number]), x[0], z[0], constants)

    n_channels = len(code.channels)
    values = np.array([back.values(sample(k))[:n_channels] for k in range(n_intervals + 1)])
    found, seeds = figure(times, values)
    after = n_intervals
    for number in np.flatnonzero(np.any(seeds != 0.0, axis=1))[::-1]:
        back.back(record, int(number) * grid.per_interval, after * grid.per_interval)
        after = int(number)
        padded = np.zeros(code.n_values)
        padded[:n_channels] = seeds[number]
        back.seed(sample(after), padded)
    back.back(record, 0, after * grid.per_interval)
    slopes = code.constant_slopes(kernel.parameters)
    by_parameter = np.asarray(slopes.T @ back.constants_adjoint)
    return FigureAdjoint(found, by_parameter, back.adjoint.copy(), record.n_bytes)
