"""Inverse dynamics along a motion: forces, multipliers and all channels at each time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vehicledyn.analyse.equilibrium import assemble
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.make_kernel import Backend, compile_kernel
from vehicledyn.multibody.equations.inverse_dynamics import InverseDynamics, derive_inverse
from vehicledyn.multibody.model.system import System

Array = NDArray[np.float64]

_SINGULAR = 1e-5
"""Ratio of the smallest and largest singular value of a loop below which a place is singular [1],
that of sweeps."""


def inverse_dynamics(
    system: System | InverseDynamics,
    times: ArrayLike,
    positions: ArrayLike,
    rates: ArrayLike,
    accelerations: ArrayLike,
    *,
    coordinates: Sequence[str] | None = None,
    backend: Backend = "auto",
) -> dict[str, Array]:
    """Return all channels along a prescribed motion, forces "<coordinate>_force" among them.

    Loops are closed at each time from where they were at the time before; further states of
    parts, such as those of relaxing tyres, stay at their start.

    Parameters
    ----------
    system
        A system, or its inverse dynamics derived before.
    times
        Shape (n_times,) [s].
    positions, rates, accelerations
        Of the prescribed coordinates, each of shape (n_times, n_coordinates) in SI.
    coordinates
        Names of the prescribed coordinates of a system; the independent ones if None.
    backend
        Passed to :func:`~vehicledyn.kernel.make_kernel.compile_kernel`.

    Returns
    -------
    dict
        Values by channel, each of shape (n_times,), in the units of the channels.

    Raises
    ------
    InputError
        If the shapes do not fit each other and the coordinates.
    NumericalError
        If a loop cannot be closed on the way; names it and the time.
    """
    inverse = system if isinstance(system, InverseDynamics) else derive_inverse(system, coordinates)
    kernel = compile_kernel(inverse.equations, backend=backend)
    instants = np.atleast_1d(np.asarray(times, dtype=float))
    motion = [_table(item, len(instants)) for item in (positions, rates, accelerations)]
    rows = [row for row, _ in channel_rows(inverse, kernel, instants, motion)]
    columns = np.array(rows).reshape(len(instants), len(inverse.equations.channels)).T
    names = [channel.name for channel in inverse.equations.channels]
    return dict(zip(names, columns, strict=True))


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


def _table(values: ArrayLike, n_times: int) -> Array:
    """Return values of shape (n_times, n_coordinates)."""
    table = np.asarray(values, dtype=float)
    if table.ndim != 2 or table.shape[0] != n_times:
        raise InputError(
            f"the motion has the shape {table.shape}; give one row for each of {n_times} times"
        )
    return table
