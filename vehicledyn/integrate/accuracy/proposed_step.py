"""The step that a fixed-step method needs, from the eigenvalues of the motion at a point."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.engine import Ledger, Method, Vector
from vehicledyn.kernel.kernel import Kernel

_REACH = {Method.RK4: 0.5, Method.SYMPLECTIC_EULER: 0.3}
"""Largest |λ| h. RK4 is stable up to 2.6; the margin is for motions that stiffen. The
semi-implicit method of order one is off by |λ| h / 2, which only slow motions must keep to."""

_DECAY, _TURN = 0.4, 0.7
"""For ``rkc`` with s stages: largest |Re λ| h / s², where 0.65 is the limit, and |Im λ| h."""

_STEP_OF_DIFFERENCE = 1e-7


def eigenvalues(
    kernel: Kernel, time: float, state: Vector, unknowns: Vector
) -> NDArray[np.complex128]:
    """Return the eigenvalues of the motion at a point, shape (n_states,), complex [1/s].

    Raises
    ------
    NumericalError
        If the motion cannot be computed in the neighbourhood of the point.
    """
    n = len(state)
    jacobian = np.zeros((n, n))
    for k in range(n):
        size = _STEP_OF_DIFFERENCE * max(0.1, abs(float(state[k])))
        ends = []
        for sign in (1.0, -1.0):
            moved, guess = np.array(state, dtype=float), np.array(unknowns, dtype=float)
            moved[k] += sign * size
            ends.append(kernel.evaluate(time, moved, guess, Ledger()))
        with np.errstate(invalid="ignore", over="ignore"):  # refused below
            jacobian[:, k] = (ends[0] - ends[1]) / (2.0 * size)
    if not np.isfinite(jacobian).all():
        raise NumericalError(f"the motion at t = {time:g} s has no finite derivatives")
    return np.asarray(np.linalg.eigvals(jacobian), dtype=np.complex128)


def longest_step(values: NDArray[np.complex128], method: int) -> float:
    """Return the longest step that a method follows modes of these eigenvalues with [s].

    Stable for all that decay, and accurate to about a hundredth in each cycle; infinite where
    nothing moves, and for implicit methods, which fast modes do not bound.
    """
    if method >= Method.IMPLICIT:
        return math.inf
    sizes = np.abs(values)
    if method < Method.CHEBYSHEV:
        largest = float(sizes.max(initial=0.0))
        return _REACH[Method(method)] / largest if largest > 0.0 else math.inf
    stages = method - Method.CHEBYSHEV
    decay, turn = np.abs(values.real).max(initial=0.0), np.abs(values.imag).max(initial=0.0)
    limits = [_DECAY * stages**2 / decay if decay else math.inf]
    limits.append(_TURN / turn if turn else math.inf)
    return float(min(limits))


def proposed_step(
    kernel: Kernel, method: int, point: tuple[float, Vector, Vector], interval: float
) -> float:
    """Return the step that suits a motion at a point and divides the sampling interval [s].

    Parameters
    ----------
    kernel
        The model with its parameters set.
    method
        As in :class:`vehicledyn.kernel.engine.March`.
    point
        Time [s], states and unknowns.
    interval
        Time between samples, which is also the longest step [s].

    Raises
    ------
    NumericalError
        If the motion cannot be computed in the neighbourhood of the point.
    """
    return dividing_step(longest_step(eigenvalues(kernel, *point), method), interval)


def dividing_step(longest: float, interval: float) -> float:
    """Return the longest step that divides an interval into a round number of steps [s].

    Round numbers are 1, 2, 4, 5 and 8 times powers of ten: 10 ms give steps of 1 ms, 0.25 ms.
    """
    wanted = max(1.0, interval / longest * (1.0 - 1e-9)) if longest > 0.0 else 1.0
    power = 10.0 ** math.floor(math.log10(wanted))
    return interval / next(n * power for n in (1, 2, 4, 5, 8, 10) if n * power >= wanted)
