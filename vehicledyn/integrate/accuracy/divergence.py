"""States that grow beyond all measure, as where a step is too long for the motion."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.engine import Vector
from vehicledyn.symbolic.equations import Equations

Matrix = NDArray[np.float64]

_HUGE = 1e12
"""State, in SI units or in its values at the start, beyond which no vehicle gets."""


class DivergenceError(NumericalError):
    """A run that must not go on in any other way, as its step is too long."""


def state_limits(state: Vector) -> Vector:
    """Return sizes (n_states,) that no motion from a start reaches."""
    with np.errstate(over="ignore"):
        return np.asarray(_HUGE * np.maximum(1.0, np.abs(state)))


def divergence(
    equations: Equations, times: Vector, states: Matrix, limits: Vector, step: float
) -> str:
    """Return what has grown first beyond its limit, with the step [s], in words; "" if nothing.

    Parameters
    ----------
    equations, limits
        The model, and what :func:`state_limits` returned of its start.
    times, states
        Samples: times (n,) [s] and states (n, n_states).
    step
        The step [s].
    """
    beyond = ~(np.abs(states) <= limits)
    rows = np.flatnonzero(beyond.any(axis=1))
    if not rows.size:
        return ""
    row, column = rows[0], int(np.argmax(beyond[rows[0]]))
    grown = equations.states[column]
    return (
        f"state '{grown.name}' is {states[row, column]:.3g} {grown.unit} at t = "
        f"{times[row]:.9g} s: the integration diverges with a step of {step * 1e3:.4g} ms"
    )
