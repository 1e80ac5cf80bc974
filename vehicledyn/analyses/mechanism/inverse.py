"""Inverse dynamics along a motion: forces, multipliers and all channels at each time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.equilibrium import assemble
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.multibody.equations.inverse_dynamics import InverseDynamics

Array = NDArray[np.float64]

_SINGULAR = 1e-5
"""Ratio of the smallest and largest singular value of a loop below which a place is singular [1],
that of sweeps."""


def channel_rows(
    inverse: InverseDynamics,
    kernel: Kernel,
    times: Array,
    motion: Sequence[Array],
    unknowns: Array | None = None,
) -> Iterator[tuple[Array, Array]]:
    """Yield the values of all channels at one time after the other, and the unknowns there.

    Parameters
    ----------
    inverse, kernel
        Inverse dynamics and their kernel.
    times
        Shape (n_times,) [s].
    motion
        Positions, rates and accelerations of the prescribed coordinates, each of shape
        (n_times, n_coordinates) in SI.
    unknowns
        Those from which the first loops are closed; their start if None.

    Raises
    ------
    NumericalError
        If a loop cannot be closed, or is at a singular place; names it and the time.
    """
    if unknowns is None:
        unknowns = np.array([variable.start for variable in inverse.equations.unknowns])
    for k, time in enumerate(times):
        state = inverse.state(*(table[k] for table in motion))
        unknowns = assemble(kernel, float(time), state, unknowns)
        _refuse_singular(kernel, float(time), state, unknowns)
        yield kernel.outputs(float(time), state, unknowns), unknowns


def _refuse_singular(kernel: Kernel, time: float, state: Array, unknowns: Array) -> None:
    """Raise NumericalError where a loop does not say how it moves, as at a dead centre."""
    for index, block in enumerate(kernel.equations.blocks):
        if block.kind != "loop":
            continue
        sizes = np.linalg.svd(kernel.block(index, time, state, unknowns)[1], compute_uv=False)
        if not sizes[-1] > _SINGULAR * sizes[0]:
            raise NumericalError(
                f"the motion reaches a singular place of block '{block.name}' at t = {time:.6g} s, "
                "as a dead centre: forces are not determined there; prescribe another coordinate"
            )
