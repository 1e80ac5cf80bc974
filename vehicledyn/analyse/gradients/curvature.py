"""Second derivatives of a figure of a motion along a direction: its Hessian times a vector.

The motion is that of the equations with their tangents along the direction; the figure's derivative
along it is a figure of that motion, whose adjoint is the Hessian times the direction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.adjoint import figure_adjoint
from vehicledyn.analyse.gradients.corner_passages import corner_passages
from vehicledyn.analyse.gradients.key_figures import FigureSlope, figure_slope, moved_slope
from vehicledyn.analyse.gradients.motion import follow
from vehicledyn.kernel.back_code import ReplacedSteps
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.kernel.tangent_code import StepRow, TangentCode
from vehicledyn.symbolic.equations import Equations
from vehicledyn.symbolic.tangent_equations import with_tangents

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Curvature:
    """A figure with its derivatives and those of its derivative along a direction.

    ``figure`` has the derivative along the direction as its only one. ``slope`` and ``curvature``
    are those by the parameters, then by the states at the start, (n_parameters,), (n_states,).
    """

    figure: FigureSlope
    slope: tuple[Vector, Vector]
    curvature: tuple[Vector, Vector]
    n_bytes: int


class CurvatureCode:
    """Compiled second derivatives of a model's motions along any direction.

    Parameters
    ----------
    equations
        The model, without events.
    channels
        Those that figures are drawn from.
    """

    def __init__(self, equations: Equations, channels: list[int]) -> None:
        self.n_channels, self.n_unknowns = len(channels), len(equations.unknowns)
        n = len(equations.channels)
        own = [*channels, *(k + n for k in channels)]
        self._equations = with_tangents(equations)
        self.code = TangentCode(self._equations, own, back=True)
        self._kernel: Kernel | None = None

    def along(
        self,
        parameters: tuple[Vector, Vector],
        grid: StepRow,
        *,
        n_intervals: int,
        start: tuple[Vector, Vector, Vector],
        figure: tuple[str, int],
        divides: bool = False,
    ) -> Curvature:
        """Return the derivatives of a figure, for given parameters and start states.

        Parameters
        ----------
        parameters
            All of them and the direction, each of shape (n_parameters,).
        grid, n_intervals
            The fixed steps, and how many sampling intervals.
        start
            States and unknowns at the start, and the tangents of the states.
        figure
            Its kind and the place of its channel.
        divides
            Whether steps are divided at corners of laws, where rates must not jump themselves.

        Raises
        ------
        InputError
            If the method is not rk4.
        CornerMissedError
            If a corner has no adjoint.
        NumericalError
            If the run cannot go on.
        """
        kind, place = figure
        n = self.n_channels

        def drawn(times: Floats, values: Floats) -> tuple[FigureSlope, Floats]:
            own, tangent = values[:, place], values[:, n + place]
            slope = figure_slope(kind, times, own, np.eye(len(times)))
            seeds = np.zeros(values.shape)
            seeds[:, place] = moved_slope(kind, times, own, tangent)
            seeds[:, n + place] = slope.slope
            return figure_slope(kind, times, own, tangent[:, None]), seeds

        state, guess, tangents = start
        both = np.concatenate([state, tangents]), np.pad(guess, (0, self.n_unknowns))
        of = np.concatenate(parameters)
        found = figure_adjoint(
            self.code,
            of,
            grid,
            n_intervals=n_intervals,
            start=both,
            figure=drawn,
            passages=self._passages(of, grid, n_intervals, both) if divides else None,
        )
        bent_p, by_p = np.split(found.by_parameter, 2)
        bent_x, by_x = np.split(found.by_state, 2)
        return Curvature(found.figure, (by_p, by_x), (bent_p, bent_x), found.n_bytes)

    def _passages(
        self, parameters: Vector, grid: StepRow, n_intervals: int, start: tuple[Vector, Vector]
    ) -> ReplacedSteps:
        """Return the steps with corners of laws, at which the rates of tangents jump."""
        self._kernel = self._kernel or compile_kernel(self._equations, backend="interpreted")
        kernel = self._kernel.with_parameters(parameters)
        none = np.zeros((len(parameters), 0)), np.zeros((len(start[0]), 0))
        motion = follow(
            self.code, kernel, grid, n_intervals=n_intervals, start=start, directions=none
        )
        return corner_passages(kernel, self.code, grid, start, motion.corners)
