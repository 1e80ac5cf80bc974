"""Motions with fixed steps and their derivatives by parameters and start values.

The derivatives are those of what the steps compute, to rounding: tangents of every stage, through
the solved constraints, and through events, whose instants move with the parameters:

    dt/dp = -(dg/dp) / (dg/dt)

for an event function g that a step reaches at the instant t. A step up to an event is one of
variable length, and so is the one behind it. Where a run changes its dependent coordinates, the
tangents of the new states are those that states and dependent coordinates had before.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.motion_course import TangentCourse
from vehicledyn.analyse.gradients.motion_slopes import MotionSlopes
from vehicledyn.analyse.gradients.motion_stretches import PartitionPiece
from vehicledyn.base.step_memory import Memory
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.tangent_code import StepRow, TangentCode

Matrix = NDArray[np.float64]

Watched = Callable[[Vector, Matrix, Matrix], object]
"""Takes samples: times (n,), states (n, n_states) and unknowns (n, n_unknowns)."""


def follow(
    code: TangentCode,
    kernel: Kernel,
    grid: StepRow,
    *,
    n_intervals: int,
    start: tuple[Vector, Vector],
    directions: tuple[Matrix, Matrix],
    later: Sequence[PartitionPiece] = (),
    n_channels: int | None = None,
    progress: Callable[[float], object] | None = None,
    watched: Watched | None = None,
    memory: Memory | None = None,
) -> MotionSlopes:
    """Return a motion and its derivatives.

    Parameters
    ----------
    code
        Compiled derivatives of the kernel's equations.
    kernel
        The model with its parameters.
    grid, n_intervals
        The fixed steps, and how many sampling intervals.
    start
        States and unknowns at the start.
    directions
        Tangents of the parameters (n_parameters, n_directions) and of the states at the start
        (n_states, n_directions).
    later
        Changes of the dependent coordinates, each at a step.
    n_channels
        Number of channels to record, the first ones of the code; all if None.
    progress
        Called with the part done.
    watched
        Called with the samples as they are found; what it raises ends the run.
    memory
        Stretches that are known, of this motion alone, whose results are :data:`KINDS`.

    Raises
    ------
    NumericalError
        If the run cannot go on, or a derivative does not exist.
    """
    count = len(code.channels) if n_channels is None else n_channels
    run = TangentCourse(PartitionPiece(grid.start, kernel, code), grid, start, directions, count)
    run.expect(later)
    memory, stretches = memory or Memory(), []
    for number in range(0, max(n_intervals, 1), run.at_once):
        done = min(number + run.at_once, n_intervals)
        stretch = memory.recall_or_raise(
            "stretch", run.place(done - number), partial(run.stretch, done - number)
        )
        run.resume_after(stretch)
        stretches.append(stretch)
        if watched is not None:
            for samples in stretch.looks:
                watched(*samples)
        if run.watch.ended_by:
            break
        if progress is not None:
            progress(done / n_intervals)
    return MotionSlopes(
        np.concatenate([stretch.times for stretch in stretches]),
        np.concatenate([stretch.values for stretch in stretches]),
        np.concatenate([stretch.slopes for stretch in stretches]),
        run.march.state.copy(),
        run.bundle.state[:, : run.n],
        run.events,
        run.watch.ended_by,
        [piece.time for piece in later],
        run.corners,
        run.left_whole,
    )
