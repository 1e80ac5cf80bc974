"""What is raised where steps of a motion that is followed fail."""

from __future__ import annotations

from typing import NoReturn

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.accuracy.divergence import divergence
from vehicledyn.kernel.engine import March, SampleRows, Status, Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.tangent_code import StepRow, TangentCode
from vehicledyn.symbolic.equations import Equations

Matrix = NDArray[np.float64]


def raise_failure(
    kernel: Kernel, code: TangentCode, march: March, n_steps: int, status: Status
) -> NoReturn:
    """Raise what a run without derivatives raises where steps fail, or that tangents do.

    Raises
    ------
    NumericalError
        Always.
    """
    e, time = kernel.equations, march.time(march.step)
    sizes = len(e.states), len(e.unknowns), len(e.channels)
    rows = SampleRows(*[np.empty((n_steps // march.per_interval + 1, size)) for size in sizes])
    found = kernel.advance(march, n_steps, rows)
    if found not in (Status.SOLVED, Status.EVENT):
        raise NumericalError(kernel.failure(found, march.time(march.step), march.ledger))
    code.check(status, time)
    raise NumericalError(f"the motion has no tangents near t = {time:.9g} s")


def refuse_divergence(
    equations: Equations, times: Vector, states: Matrix, limits: Vector, grid: StepRow
) -> None:
    """Refuse a motion that has grown beyond all measure.

    Raises
    ------
    NumericalError
        If a state of a sample is beyond its limit.
    """
    step = grid.interval / grid.per_interval
    if found := divergence(equations, times, states, limits, step):
        raise NumericalError(f"{found}; take a shorter step")
