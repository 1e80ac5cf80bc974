"""A path y(x) of smooth steps between places that are parameters."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.parameters import ParameterTable

_SHARPEST = 10.0 / math.sqrt(3.0)
"""Largest second derivative of s³ (10 - 15 s + 6 s²), its slope left out [1]."""


@dataclass(frozen=True)
class StepPath:
    """y(x) from one place to the next by s³ (10 - 15 s + 6 s²), of continuous curvature.

    ``places`` are positions x that increase, ``offsets`` the y there, constant outside [m].
    """

    places: tuple[float, ...]
    offsets: tuple[float, ...]

    def tightest(self) -> tuple[float, float]:
        """Return the smallest radius of the steps and the x of the step's begin [m]."""
        radius, place = math.inf, self.places[0]
        steps = zip(self.places, self.places[1:], self.offsets, self.offsets[1:], strict=False)
        for begin, end, before, after in steps:
            if before != after:
                here = (end - begin) ** 2 / (_SHARPEST * abs(after - before))
                if here < radius:
                    radius, place = here, begin
        return radius, place

    def settings(self, name: str) -> Iterator[tuple[str, float]]:
        """Yield the parameters by name with their values."""
        for k, (place, offset) in enumerate(zip(self.places, self.offsets, strict=True)):
            yield f"{name}.x_{k}", place
            yield f"{name}.y_{k}", offset

    def enter(self, table: ParameterTable, name: str) -> Callable[[Scalar], Scalar]:
        """Enter the places as parameters and return the path."""
        found = {key: table.add(key, value, "m", "Path") for key, value in self.settings(name)}
        xs = [found[f"{name}.x_{k}"] for k in range(len(self.places))]
        ys = [found[f"{name}.y_{k}"] for k in range(len(self.places))]

        def path(x: Scalar) -> Scalar:
            total = ys[0]
            for k in range(len(xs) - 1):
                s = ops.minimum(ops.maximum((x - xs[k]) / (xs[k + 1] - xs[k]), 0.0), 1.0)
                total += (ys[k + 1] - ys[k]) * s * s * s * (10.0 - s * (15.0 - 6.0 * s))
            return total

        return path
