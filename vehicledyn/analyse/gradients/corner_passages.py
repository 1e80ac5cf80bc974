"""Steps with corners of laws as adjoints pass them: where they end, and the derivatives of that."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from vehicledyn.analyse.gradients.motion_course import TangentCourse
from vehicledyn.analyse.gradients.motion_slopes import CornerPassed
from vehicledyn.analyse.gradients.motion_stretches import PartitionPiece
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.back_code import ReplacedStep, ReplacedSteps
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.tangent_code import StepRow, TangentCode


class CornerMissedError(NumericalError):
    """A step that was divided is whole by itself; tangents go through it."""


def corner_passages(
    kernel: Kernel,
    code: TangentCode,
    grid: StepRow,
    start: tuple[Vector, Vector],
    corners: Sequence[CornerPassed],
) -> ReplacedSteps:
    """Return the steps in which a motion was divided at corners of laws.

    Parameters
    ----------
    kernel, code, grid
        The model, its compiled derivatives and the steps.
    start
        States and unknowns at the start.
    corners
        Those that the motion passed as it was followed.
    """
    n_x, n_p = len(kernel.equations.states), len(kernel.parameters)
    by_parameter = np.hstack([np.zeros((n_p, n_x)), np.eye(n_p)])
    by_state = np.hstack([np.eye(n_x), np.zeros((n_x, n_p))])
    piece = PartitionPiece(grid.start, kernel, code)
    course = TangentCourse(piece, grid, start, (by_parameter, by_state), 0)

    def taken(step: int, state: Vector, unknowns: Vector) -> ReplacedStep:
        if not course.passes(piece, step, (state, unknowns)):
            raise CornerMissedError(
                f"the motion has no adjoint over the corner at t = {course.time:.9g} s"
            )
        end, slopes = course.march, course.bundle.state
        parts = slopes[:, :n_x], slopes[:, n_x : n_x + n_p]
        return ReplacedStep(end.state.copy(), end.unknowns.copy(), *parts)

    step = grid.interval / grid.per_interval
    return ReplacedSteps([round((item.time - grid.start) / step) for item in corners], taken)
