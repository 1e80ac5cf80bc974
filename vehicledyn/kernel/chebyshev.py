"""Weights of the Runge-Kutta-Chebyshev method, for the interpreted kernel."""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np

from vehicledyn.kernel.engine import Vector

DAMPING = 2.0 / 13.0


class ChebyshevWeights(NamedTuple):
    """Weights by stage, shape (stages + 1,); the names are those of steps.c."""

    last: Vector
    before: Vector
    rate: Vector
    first_rate: Vector
    place: Vector


@lru_cache(maxsize=64)
def chebyshev_weights(stages: int) -> ChebyshevWeights:
    """Return what the stages of a step add up.

    Parameters
    ----------
    stages
        Their number s, two or more; the step is stable for real λ h down to about -0.65 s².

    References
    ----------
    Sommeijer, Shampine, Verwer (1998), RKC: an explicit solver for parabolic PDEs, Journal of
    Computational and Applied Mathematics 88, 315-326, equations (2.4) to (2.8).
    """
    w0 = 1.0 + DAMPING / stages**2
    value, slope, bend = np.zeros((3, stages + 1))
    value[:2], slope[1] = (1.0, w0), 1.0
    for j in range(2, stages + 1):
        value[j] = 2.0 * w0 * value[j - 1] - value[j - 2]
        slope[j] = 2.0 * value[j - 1] + 2.0 * w0 * slope[j - 1] - slope[j - 2]
        bend[j] = 4.0 * slope[j - 1] + 2.0 * w0 * bend[j - 1] - bend[j - 2]
    b = np.full(stages + 1, bend[2] / slope[2] ** 2)
    b[2:] = bend[2:] / slope[2:] ** 2
    w1 = slope[stages] / bend[stages]
    weights = ChebyshevWeights(*np.zeros((5, stages + 1)))
    weights.rate[1] = b[1] * w1
    weights.last[2:] = 2.0 * b[2:] * w0 / b[1:-1]
    weights.before[2:] = -b[2:] / b[:-2]
    weights.rate[2:] = 2.0 * b[2:] * w1 / b[1:-1]
    weights.first_rate[2:] = -(1.0 - b[1:-1] * value[1:-1]) * weights.rate[2:]
    weights.place[2:] = w1 * bend[2:] / slope[2:]
    weights.place[1] = weights.place[2] / slope[2]
    return weights
