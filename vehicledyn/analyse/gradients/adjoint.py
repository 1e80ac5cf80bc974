"""Derivatives of one figure of a motion by all parameters and start values, by adjoints."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.key_figures import FigureSlope
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.kernel.back_code import BackCode, ReplacedSteps
from vehicledyn.kernel.engine import Method, Vector
from vehicledyn.kernel.tangent_code import StepRow, TangentCode
from vehicledyn.symbolic.equations import Equations

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


class EventPassedError(NumericalError):
    """An event happens in a motion that adjoints are to go back over; tangents go through it."""


def goes_back(equations: Equations) -> bool:
    """Return whether adjoints follow a model: its events, if any, do no more than end a run."""
    return all(event.terminal and not event.resets for event in equations.events)


def figure_adjoint(
    code: TangentCode,
    parameters: Vector,
    grid: StepRow,
    *,
    n_intervals: int,
    start: tuple[Vector, Vector],
    figure: Figure,
    passages: ReplacedSteps | None = None,
) -> FigureAdjoint:
    """Return the derivatives of a figure; those of the start state are by all states alone.

    Parameters
    ----------
    code
        Compiled derivatives of the equations, made with ``back``.
    parameters
        All of them, shape (n_parameters,).
    grid, n_intervals
        The fixed steps, and how many sampling intervals.
    start
        States and unknowns at the start.
    figure
        Draws the figure from the samples of the code's channels.
    passages
        Steps that are taken in another way, such as those with corners of laws.

    Raises
    ------
    InputError
        If the method is not rk4 or the model has events that do more than end a run.
    EventPassedError
        If an event happens.
    NumericalError
        If the run cannot go on.
    """
    if grid.method != Method.RK4:
        raise InputError("adjoints are those of rk4; choose solver.kind rk4")
    if not goes_back(code.equations):
        raise InputError(f"adjoints do not follow the events of '{code.equations.name}'")
    constants = code.constants(parameters)
    back = BackCode(code, grid, constants, passages)
    state, guess = start
    unknowns = code.solved(grid.start, state, guess, constants)
    record = back.record(n_intervals, (state, unknowns))
    samples, times = record.samples, record.samples.times
    n_channels = len(code.channels)
    values = back.values(samples)
    _refuse_events(code.equations, times, values[:, n_channels:])
    found, seeds = figure(times, values[:, :n_channels])
    padded = np.zeros((len(times), code.n_values))
    padded[:, :n_channels] = seeds
    by_state = back.seeded(samples, padded)
    back.adjoint += by_state[-1]
    back.back(record, by_state)
    slopes = code.constant_slopes(parameters)
    by_parameter = np.asarray(slopes.T @ back.constants_adjoint) + back.passages_adjoint
    return FigureAdjoint(found, by_parameter, back.adjoint.copy(), record.n_bytes)


def _refuse_events(equations: Equations, times: Floats, values: Floats) -> None:
    """Raise EventPassedError if a sample lies behind an event."""
    for event in equations.events:
        own = values[:, event.index] * (-1.0 if event.direction == "falling" else 1.0)
        if event.direction == "either" and own[0] > 0.0:
            own = -own
        behind = np.flatnonzero((own > 0.0) & (own[0] < 0.0))
        if behind.size:
            raise EventPassedError(
                f"event '{event.name}' happens before t = {times[behind[0]]:.6g} s"
            )
