"""Surfaces given by numbers: heights over a grid, linear across and linear or cubic along it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from vehicledyn.base.numbers.shape_preserving import level_slopes
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.tables import Array, CurveTable


@dataclass(frozen=True, eq=False)
class GridTable:
    """A surface z(u, v) through values at equal steps of u and growing places v.

    Beyond the grid it keeps the value at its edge. Across the grid, between two v, it is linear.
    The methods take and return floats or expressions.

    Parameters
    ----------
    name
        What the surface is, for messages.
    start, step
        First u and its step, positive.
    v
        Places across, growing, shape (n_v,), at least two.
    values
        Shape (n_u, n_v), finite.
    smooth
        Whether the curves along u are cubics with continuous slope that keep the shape of the
        values, or straight lines from value to value.
    """

    name: str
    start: float
    step: float
    v: Array
    values: Array
    smooth: bool = True

    @cached_property
    def _columns(self) -> CurveTable:
        """All curves along u, one after the other; each ends with a level cell."""
        count = len(self.values)
        pieces = []
        for column in self.values.T:
            rises = np.diff(column)
            slopes = rises
            curve = [column[:-1], rises]
            if self.smooth:
                slopes = level_slopes(np.arange(count, dtype=float), column)
                first, last = slopes[:-1], slopes[1:]
                curve = [column[:-1], first, 3.0 * rises - 2.0 * first - last]
                curve.append(first + last - 2.0 * rises)
            level = [column[-1:]] + [np.zeros(1)] * (len(curve) - 1)
            pieces.append(np.stack([np.concatenate(p) for p in zip(curve, level, strict=True)], 1))
        return CurveTable(self.name, 0.0, 1.0, np.concatenate(pieces))

    @cached_property
    def _across(self) -> CurveTable | None:
        """Number of the cell at a place v, for places at equal distances; None for others."""
        steps = np.diff(self.v)
        if np.ptp(steps) > 1e-9 * steps[0]:
            return None
        numbers = np.arange(len(steps), dtype=float)
        step = float(self.v[-1] - self.v[0]) / len(steps)
        rows = np.column_stack([numbers, np.zeros_like(numbers)])
        return CurveTable(f"{self.name}: sections", float(self.v[0]), step, rows)

    def value(self, u: Any, v: Any) -> Any:
        """Return the height at a place."""
        place, column, share, _, _ = self._place(u, v)
        low, high = (self._columns.value(place + n) for n in self._pair(column))
        return low + share * (high - low)

    def slopes(self, u: Any, v: Any) -> tuple[Any, Any]:
        """Return the slopes along u and v."""
        place, column, share, into_u, into_v = self._place(u, v)
        pair = self._pair(column)
        low, high = (self._columns.value(place + n) for n in pair)
        low_slope, high_slope = (self._columns.slope(place + n) for n in pair)
        along = (low_slope + share * (high_slope - low_slope)) * into_u
        return along, (high - low) * into_v

    def _pair(self, column: Any) -> tuple[Any, Any]:
        count = float(len(self.values))
        return column * count, column * count + count

    def _place(self, u: Any, v: Any) -> tuple[Any, Any, Any, Any, Any]:
        """Return place along, number of the cell, share across, and their rates by u and v."""
        last = float(len(self.values) - 1)
        raw = (u - self.start) / self.step
        place = ops.minimum(ops.maximum(raw, 0.0), last)
        inside_u = ops.where(ops.logic_and(raw >= 0.0, raw < last), 1.0 / self.step, 0.0)
        right, left = float(self.v[0]), float(self.v[-1])
        inside_v = ops.where(ops.logic_and(v >= right, v < left), 1.0, 0.0)
        held = ops.minimum(ops.maximum(v, right), left)
        column, low, width = self._section(held)
        return place, column, (held - low) / width, inside_u, inside_v / width

    def _section(self, v: Any) -> tuple[Any, Any, Any]:
        """Return number, right edge and width of the cell at a place v between the edges."""
        if self._across is not None:
            column = self._across.value(v)
            width = self._across.step
            return column, float(self.v[0]) + column * width, width
        column, low, width = 0.0, float(self.v[0]), float(self.v[1] - self.v[0])
        for index in range(1, len(self.v) - 1):
            edge, wide = float(self.v[index]), float(self.v[index + 1] - self.v[index])
            beyond = v >= edge
            column = ops.where(beyond, float(index), column)
            low, width = ops.where(beyond, edge, low), ops.where(beyond, wide, width)
        return column, low, width
