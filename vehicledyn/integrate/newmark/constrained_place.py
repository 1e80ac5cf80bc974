"""Where steps on residuals with multipliers are, and what they begin with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vehicledyn.integrate.events import ConsistentPoint
from vehicledyn.integrate.newmark.residual_functions import Instant, ResidualFunctions
from vehicledyn.kernel.engine import Vector

_SHORT = 1e-6
"""Time over which a slope is found [s]."""


@dataclass(frozen=True)
class ConstrainedPlace:
    """A point of a motion, with what the step to come needs of it.

    ``auxiliary`` are the acceleration-like a and its like for further states, ``other_rate`` the
    true rates of these. ``correction`` is η, ``size`` the step that led here [s], and ``change``
    what it added to a, None where the motion starts: ``bend`` is b there.
    """

    point: ConsistentPoint
    instant: Instant
    auxiliary: tuple[Vector, Vector]
    other_rate: Vector
    correction: Vector
    size: float
    change: Vector | None = None
    bend: Vector | None = None

    @property
    def numbers(self) -> Vector | None:
        """What a run goes on with from here, None where the motion starts anew."""
        if self.change is None:
            return None
        at, (a, r) = self.instant, self.auxiliary
        parts = at.acceleration, at.multiplier, a, r, self.other_rate, self.correction
        return np.concatenate([[self.size], *parts, self.change])


@dataclass(frozen=True)
class KnownOfStep:
    """What the unknowns of a step change: the state at its start, carried by known terms."""

    time: float
    size: float
    position: Vector
    velocity: Vector
    acceleration: Vector
    other: Vector
    lag: Vector
    old: tuple[Vector, Vector]


def resumed_place(
    functions: ResidualFunctions, point: ConsistentPoint, numbers: Vector, *, is_stabilised: bool
) -> ConstrainedPlace:
    """Return the place at a point that has these :attr:`ConstrainedPlace.numbers`."""
    n, k, m = functions.sizes
    e, state = functions.equations, point.state
    q, v, s = (state[list(part)] for part in (e.positions, e.velocities, e.others))
    ends = np.cumsum([1, n, m, n, k, k, m if is_stabilised else 0])
    size, lift, forces, a, r, rate, eta, change = np.split(numbers, ends)
    instant = Instant(point.time, q, v, lift, forces, s)
    kept = ConsistentPoint(point.time, state.copy(), point.unknowns.copy())
    return ConstrainedPlace(kept, instant, (a, r), rate, eta, float(size[0]), change)


def slope_of_lift(functions: ResidualFunctions, at: Instant, parameters: Vector) -> Vector:
    """Return how fast the accelerations of the constraints change with those of the coordinates.

    It is that of the motion to come, of which laws in time may have another before; zero where it
    is no finite number.
    """
    rows = []
    for k in range(1, 4):
        h = k * _SHORT
        ahead = at._replace(
            time=at.time + h,
            position=at.position + h * (at.velocity + 0.5 * h * at.acceleration),
            velocity=at.velocity + h * at.acceleration,
        )
        rows.append(functions.lift(ahead, parameters))
    slope: Vector = (-2.5 * rows[0] + 4.0 * rows[1] - 1.5 * rows[2]) / _SHORT
    return slope if np.isfinite(slope).all() else np.zeros_like(slope)
