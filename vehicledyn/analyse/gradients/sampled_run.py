"""A plain run with fixed steps and all its channels."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.step_failures import refuse_divergence
from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.accuracy.divergence import state_limits
from vehicledyn.kernel.engine import March, SampleRows, Status, Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.tangent_code import StepRow

Matrix = NDArray[np.float64]


def sampled_run(
    kernel: Kernel, grid: StepRow, n_intervals: int, start: tuple[Vector, Vector]
) -> tuple[Vector, Matrix, Vector]:
    """Return times, all channels (n_times, n_channels) and the last state of a plain run.

    Raises
    ------
    NumericalError
        If it cannot go on.
    """
    e = kernel.equations
    unknowns = kernel.solve_unknowns(grid.start, *start)
    sides = np.zeros(len(e.events), dtype=np.intc)
    steps = (grid.method, grid.start, grid.interval, grid.per_interval)
    march = March(*steps, start[0], unknowns, sides=sides)
    sizes = (len(e.states), len(e.unknowns), len(e.channels))
    rows = SampleRows(*[np.empty((n_intervals + 1, size)) for size in sizes])
    first = kernel.outputs(grid.start, start[0], unknowns)
    status = kernel.advance(march, n_intervals * grid.per_interval, rows)
    if status is not Status.SOLVED:
        time = march.time(march.step)
        raise NumericalError(kernel.failure(status, time, march.ledger))
    times = np.asarray(grid.start + grid.interval * np.arange(n_intervals + 1), dtype=float)
    refuse_divergence(e, times[1:], rows.states[:n_intervals], state_limits(start[0]), grid)
    return times, np.vstack([first, rows.outputs[:n_intervals]]), march.state.copy()
