"""What is to be optimised along a motion: controls, limits, conditions, objective, path."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.symbolic.equations import Equations

Floats = NDArray[np.float64]

POINTS, RAMP, BEND = 0, 1, 2
"""How a control goes within an interval: through free values at the collocation points, straight,
or with constant acceleration; the last two are continuous."""


@dataclass(frozen=True)
class Control:
    """A function of time that enters parameters of the model.

    ``order`` is :data:`POINTS`, :data:`RAMP` or :data:`BEND`; ``entries`` are (index of the
    parameter, derivative 0 to 2, factor); ``low``, ``high`` bound it, ``rate`` its derivative and
    ``acceleration`` its second one, in SI; ``start``, ``end`` are bounds at the ends.
    """

    name: str
    unit: str
    order: int
    entries: tuple[tuple[int, int, float], ...]
    low: float
    high: float
    rate: float = np.inf
    acceleration: float = np.inf
    start: tuple[float, float] = (-np.inf, np.inf)
    end: tuple[float, float] = (-np.inf, np.inf)

    @property
    def size(self) -> float:
        """What its values are measured by."""
        finite = [abs(v) for v in (self.low, self.high) if np.isfinite(v) and v]
        return max(finite, default=1.0)

    @property
    def highest(self) -> float:
        """What its highest derivative is measured by: its bound, else its size over a second."""
        bound = {RAMP: self.rate, BEND: self.acceleration}.get(self.order, np.inf)
        return bound if np.isfinite(bound) else self.size


@dataclass(frozen=True)
class PointExpression:
    """A quantity at a point of the motion.

    ``kind`` is "state", "unknown", "channel", "control" with their index, "path" with 0 for the
    distance and 1 for the offset, or "square" of the sum of squares of ``parts``.
    """

    name: str
    kind: str
    index: int = -1
    parts: tuple[PointExpression, ...] = ()


@dataclass(frozen=True)
class BoundedExpression:
    """An expression with the bounds it must keep, in SI."""

    what: PointExpression
    low: float
    high: float


@dataclass(frozen=True)
class Corridor:
    """A path in the plane with its corridor.

    ``distance``, ``x``, ``y``, ``right`` and ``left`` (n,) in m: places along it and how far a
    motion may go to both sides; ``place`` are the indices of the states x and y that follow it.
    """

    distance: Floats
    x: Floats
    y: Floats
    right: Floats
    left: Floats
    place: tuple[int, int]


@dataclass(frozen=True)
class ControlProblem:
    """An optimal-control problem.

    ``parameters`` (n_p,) are the model's values; ``duration`` bounds the final time; ``start`` and
    ``end`` bound the states (n_x, 2) there; ``limits`` hold everywhere, ``final`` at the end;
    ``growth`` maps states of a periodic motion to what they gain in a cycle. ``terms`` are pairs
    (weight, what) of the objective: what is ("time",), ("effort",), ("smoothness",), the squares of
    the highest derivatives that controls have, ("power", control, state),
    ("integral", expression), ("square", expression) or ("final", expression).
    """

    equations: Equations
    parameters: Floats
    controls: tuple[Control, ...]
    duration: tuple[float, float]
    start: Floats
    end: Floats
    bounds: Floats
    limits: tuple[BoundedExpression, ...]
    final: tuple[BoundedExpression, ...]
    terms: tuple[tuple[float, tuple[Any, ...]], ...]
    growth: dict[int, float] = field(default_factory=dict)
    path: Corridor | None = None
    path_start: tuple[float, float] = (-np.inf, np.inf)

    def parameters_with(self, values: Floats) -> Floats:
        """Return the model's parameters under values of the controls and derivatives, (3, n_u)."""
        numbers = self.parameters.copy()
        for k, control in enumerate(self.controls):
            for index, order, factor in control.entries:
                numbers[index] += factor * values[order, k]
        return numbers
