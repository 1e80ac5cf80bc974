"""How curvature and cant change along a piece of track: shapes of transitions.

A shape f runs from 0 to 1 over the piece, u from 0 to 1 being the share of its length. The
curvature is κ = κ₀ + (κ₁ - κ₀) f(u), and cant and widening follow the same f. The cubic parabola
is given by its plan instead and has a module function of its own.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_NEWTON_STEPS = 40
"""More than enough: the slope of the arc is known but for a small part."""


@dataclass(frozen=True)
class Shape:
    """A shape f(u), its derivative and its integral from zero."""

    share: Callable[[Array], Array]
    slope: Callable[[Array], Array]
    swept: Callable[[Array], Array]


SHAPES = {
    "linear": Shape(lambda u: u, np.ones_like, lambda u: 0.5 * u * u),
    "bloss": Shape(
        lambda u: u * u * (3.0 - 2.0 * u),
        lambda u: 6.0 * u * (1.0 - u),
        lambda u: u**3 * (1.0 - 0.5 * u),
    ),
    "cosine": Shape(
        lambda u: 0.5 - 0.5 * np.cos(math.pi * u),
        lambda u: 0.5 * math.pi * np.sin(math.pi * u),
        lambda u: 0.5 * u - np.sin(math.pi * u) / (2.0 * math.pi),
    ),
    "klein": Shape(
        lambda u: u - np.sin(2.0 * math.pi * u) / (2.0 * math.pi),
        lambda u: 1.0 - np.cos(2.0 * math.pi * u),
        lambda u: 0.5 * u * u + (np.cos(2.0 * math.pi * u) - 1.0) / (4.0 * math.pi**2),
    ),
}
"""Clothoid; Bloss: cubic f; cosine: half a wave; Klein: sine, with f'' continuous too."""


def cubic_parabola(distance: Array, length: Any, end_curvature: Any) -> tuple[Array, Array]:
    """Return curvature [1/m] and heading [rad] of y = x³ κ₁ / (6 X) at a distance from its start.

    The abscissa X of the end is the one whose arc is as long as the piece. The curvature at the
    end is that of the circle but for the factor (1 + X² κ₁²/4)^(-3/2), as railways accept it.

    Parameters
    ----------
    distance
        Length of the arc from where it is straight, any shape [m].
    length
        Length of the piece [m].
    end_curvature
        κ₁, that of the circle it leads to [1/m].
    """
    bend = np.asarray(end_curvature, dtype=float)
    end = _abscissa(np.asarray(length, dtype=float), lambda x: 0.5 * bend * x)
    steepness = 0.5 * bend / end
    x = _abscissa(np.asarray(distance, dtype=float), lambda x: steepness * x * x)
    slope = steepness * x * x
    return 2.0 * steepness * x / (1.0 + slope * slope) ** 1.5, np.arctan(slope)


def _abscissa(length: Array, slope: Callable[[Array], Array]) -> Array:
    """Return x up to which a cubic parabola is as long as asked; ``slope`` is dy/dx there."""
    nodes, weights = np.polynomial.legendre.leggauss(24)
    fourth = (0.5 * (nodes + 1.0)) ** 4
    x = np.array(length)
    for _ in range(_NEWTON_STEPS):
        end = np.asarray(slope(x)) ** 2
        arc = 0.5 * x * (np.sqrt(1.0 + end[..., None] * fourth) @ weights)
        step = (arc - length) / np.sqrt(1.0 + end)
        x = x - step
        if np.all(np.abs(step) <= 1e-15 * (1.0 + np.abs(x))):
            break
    return x
