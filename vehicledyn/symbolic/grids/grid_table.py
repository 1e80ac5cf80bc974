"""Surfaces given by numbers: heights over a grid, linear across and linear or cubic along it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from vehicledyn.base.numbers.shape_preserving import level_slopes
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.grids.run_time_numbers import RunTimeNumbers
from vehicledyn.symbolic.tables import Array, CurveTable


class _Cell(NamedTuple):
    """A cell across the grid: number, right edge, width, and the widths of its neighbours."""

    column: Any
    low: Any
    width: Any
    before: Any
    after: Any


class _Sizes(NamedTuple):
    """What differs between grids: along them, across them, and their edges to either side."""

    start: Any
    step: Any
    last: Any
    count: Any
    right: Any
    left: Any
    width: Any
    radius: Any
    most: Any


class _Kink(NamedTuple):
    """The nearest v: the column beyond it, whether it is the left one, and how near it is [m]."""

    column: Any
    is_left: Any
    rest: Any


@dataclass(frozen=True, eq=False)
class GridTable:
    """A surface z(u, v) through values at equal steps of u and growing places v.

    Beyond the grid it keeps the value at its edge. Across the grid, between two v, it is linear;
    near each v it may be rounded by a parabola, the mean of the straight lines over some width.
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
    rounding
        Half of the width that is rounded at each v [as v]; at most a quarter of the narrowest cell.
    """

    name: str
    start: float
    step: float
    v: Array
    values: Array
    smooth: bool = True
    rounding: float = 0.0

    @cached_property
    def _radius(self) -> float:
        return min(self.rounding, 0.25 * float(np.diff(self.v).min()))

    @cached_property
    def _sections(self) -> tuple[Array, Array]:
        """Places across and values; of a rounded surface with a level cell beyond each edge."""
        if not self.rounding:
            return self.v, self.values
        right, left = 2.0 * self.v[0] - self.v[1], 2.0 * self.v[-1] - self.v[-2]
        values = np.column_stack([self.values[:, 0], self.values, self.values[:, -1]])
        return np.array([right, *self.v, left]), values

    @cached_property
    def _columns(self) -> CurveTable:
        """All curves along u, one after the other; each ends with a level cell."""
        count = len(self.values)
        pieces = []
        for column in self._sections[1].T:
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
        v = self._sections[0]
        steps = np.diff(v)
        if np.ptp(steps) > 1e-9 * steps[0]:
            return None
        numbers = np.arange(len(steps), dtype=float)
        step = float(v[-1] - v[0]) / len(steps)
        rows = np.column_stack([numbers, np.zeros_like(numbers)])
        return CurveTable(f"{self.name}: sections", float(v[0]), step, rows)

    @cached_property
    def _numbers(self) -> RunTimeNumbers:
        """The sizes, which compiled code looks up."""
        places, count = self._sections[0], float(len(self.values))
        width = float(places[-1] - places[0]) / (len(places) - 1)
        radius = self._radius if self.rounding else 0.0
        edges = float(places[0]), float(places[-1])
        sizes = _Sizes(
            self.start, self.step, count - 1.0, count, *edges, width, radius, len(places) - 1.0
        )
        return RunTimeNumbers(f"{self.name}: sizes", sizes)

    def _sizes(self, u: Any, v: Any) -> _Sizes:
        """Return the sizes, as numbers where both places are numbers."""
        return _Sizes(*self._numbers.at(u, v))

    def value(self, u: Any, v: Any) -> Any:
        """Return the height at a place."""
        sizes = self._sizes(u, v)
        place, _ = self._along(u, sizes)
        cell, share, _ = self._across_at(v, sizes)
        both = cell.column, cell.column + 1.0
        low, high = (self._value(place, column, sizes) for column in both)
        found = low + share * (high - low)
        if not self.rounding:
            return found
        near = self._kink(v, cell, sizes)
        bend = self._bend(near, cell, low, high, self._value(place, near.column, sizes))
        return found + bend * near.rest * near.rest / (4.0 * sizes.radius)

    def slopes(self, u: Any, v: Any) -> tuple[Any, Any]:
        """Return the slopes along u and v."""
        sizes = self._sizes(u, v)
        place, into_u = self._along(u, sizes)
        cell, share, into_v = self._across_at(v, sizes)
        both = cell.column, cell.column + 1.0
        low, high = (self._value(place, column, sizes) for column in both)
        low_slope, high_slope = (self._slope(place, column, sizes) for column in both)
        along, across = low_slope + share * (high_slope - low_slope), (high - low) * into_v
        if self.rounding:
            near, r = self._kink(v, cell, sizes), sizes.radius
            bend = self._bend(near, cell, low, high, self._value(place, near.column, sizes))
            across = across + bend * ops.where(near.is_left, near.rest, -near.rest) / (2.0 * r)
            beyond = self._slope(place, near.column, sizes)
            bend = self._bend(near, cell, low_slope, high_slope, beyond)
            along = along + bend * near.rest * near.rest / (4.0 * r)
        return along * into_u, across

    def _value(self, place: Any, column: Any, sizes: _Sizes) -> Any:
        return self._columns.value(place + column * sizes.count)

    def _slope(self, place: Any, column: Any, sizes: _Sizes) -> Any:
        return self._columns.slope(place + column * sizes.count)

    def _along(self, u: Any, sizes: _Sizes) -> tuple[Any, Any]:
        """Return the place along the grid in steps, and its rate by u."""
        raw = (u - sizes.start) / sizes.step
        place = ops.minimum(ops.maximum(raw, 0.0), sizes.last)
        inside = ops.logic_and(raw >= 0.0, raw < sizes.last)
        return place, ops.where(inside, 1.0 / sizes.step, 0.0)

    def _across_at(self, v: Any, sizes: _Sizes) -> tuple[_Cell, Any, Any]:
        """Return the cell across, the share of its left edge, and the rate of that by v."""
        inside = ops.where(ops.logic_and(v >= sizes.right, v < sizes.left), 1.0, 0.0)
        held = ops.minimum(ops.maximum(v, sizes.right), sizes.left)
        cell = self._cell(held, sizes)
        return cell, (held - cell.low) / cell.width, inside / cell.width

    def _kink(self, v: Any, cell: _Cell, sizes: _Sizes) -> _Kink:
        """Return the v whose rounding a place may be in."""
        held = ops.minimum(ops.maximum(v, sizes.right), sizes.left)
        is_left = held - cell.low > 0.5 * cell.width
        far = ops.where(is_left, cell.low + cell.width - held, held - cell.low)
        beyond = ops.where(is_left, cell.column + 2.0, cell.column - 1.0)
        column = ops.minimum(ops.maximum(beyond, 0.0), sizes.most)
        return _Kink(column, is_left, ops.maximum(sizes.radius - far, 0.0))

    def _bend(self, near: _Kink, cell: _Cell, low: Any, high: Any, beyond: Any) -> Any:
        """Return how much the slope across changes at the nearest v, from right to left."""
        own = (high - low) / cell.width
        return ops.where(
            near.is_left, (beyond - high) / cell.after - own, own - (low - beyond) / cell.before
        )

    def _cell(self, v: Any, sizes: _Sizes) -> _Cell:
        """Return the cell at a place v between the edges."""
        if self._across is not None:
            column, width = self._across.value(v), sizes.width
            return _Cell(column, sizes.right + column * width, width, width, width)
        places = self._sections[0]
        widths = np.diff(places)
        cells = [
            _Cell(float(k), float(places[k]), float(widths[k]), float(widths[max(k - 1, 0)]),
                  float(widths[min(k + 1, len(widths) - 1)]))
            for k in range(len(widths))
        ]  # fmt: skip
        found = cells[0]
        for cell in cells[1:]:
            beyond = v >= cell.low
            found = _Cell(*(ops.where(beyond, a, b) for a, b in zip(cell, found, strict=True)))
        return found
