"""OpenCRG roads as ground that wheels drive on: heights by world coordinates, for expressions."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from vehicledyn.base.errors import InputError
from vehicledyn.road.opencrg.road import Border, CrgRoad
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.grids.grid_table import GridTable
from vehicledyn.symbolic.grids.run_time_numbers import RunTimeNumbers
from vehicledyn.symbolic.tables import CurveTable

ROUNDING = 0.05
"""Half of the width over which the kinks at long sections are rounded [m]."""

_STEPS = 4
_FINEST_CELL = 1.0
_MOST_CELLS = 500_000
_MARGIN = 10.0
_STRAIGHT = 1e-9


class _Map(NamedTuple):
    """First guesses of u [m] in square cells, and the numbers of their columns and rows.

    ``sizes`` are its left and its lower edge, the side of a cell [m] and the number of rows.
    """

    guesses: CurveTable
    columns: CurveTable
    rows: CurveTable
    sizes: RunTimeNumbers


@dataclass(frozen=True, eq=False)
class CrgGround:
    """The surface z(x, y) of a road.

    A curved reference line becomes a smooth curve through its corners; a place belongs to the
    point of the line whose normal it lies on, found by Newton's method from the corner that is
    nearest to a cell of a map.
    """

    road: CrgRoad
    smooth: bool

    @cached_property
    def grid(self) -> GridTable:
        """Heights with those of the line and the bank, over u and v [m]."""
        road = self.road
        nodes = road.line.start + road.line.step * np.arange(len(road.heights), dtype=np.float64)
        exact = replace(road, borders=replace(road.borders, smooth_start=0.0, smooth_end=0.0))
        heights = exact.height(nodes[:, None], np.clip(road.v, *road.edges)[None, :])
        if np.isnan(heights).any():
            raise InputError(
                f"{road.gaps() or 'the road has heights that are no number'}; measure them, or "
                "fill them with the modifier grid_nan_mode in $ROAD_CRG_MODS: 1 for zero, 2 for "
                "the height of the neighbour towards the middle"
            )
        rounding = ROUNDING if self.smooth else 0.0
        start, step = road.line.start, road.line.step
        return GridTable("road", start, step, road.v, heights, self.smooth, rounding)

    @cached_property
    def _curve(self) -> tuple[CurveTable, CurveTable]:
        line = self.road.line
        x, y = (
            CurveTable.through("road line", line.start, line.step, of) for of in (line.x, line.y)
        )
        return x, y

    @cached_property
    def is_straight(self) -> bool:
        """Whether the reference line is straight."""
        line = self.road.line
        return bool(np.ptp(np.diff(line.x)) < _STRAIGHT and np.ptp(np.diff(line.y)) < _STRAIGHT)

    @cached_property
    def _map(self) -> _Map:
        line = self.road.line
        reach = max(abs(self.road.v[0]), abs(self.road.v[-1])) + _MARGIN
        left, low = line.x.min() - reach, line.y.min() - reach
        wide, high = np.ptp(line.x) + 2.0 * reach, np.ptp(line.y) + 2.0 * reach
        cell = max(_FINEST_CELL, math.sqrt(wide * high / _MOST_CELLS))
        columns, rows = math.ceil(wide / cell), math.ceil(high / cell)
        x = left + (np.arange(columns) + 0.5) * cell
        y = low + (np.arange(rows) + 0.5) * cell
        places = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1).reshape(-1, 2)
        nearest = cKDTree(np.column_stack([line.x, line.y])).query(places)[1]
        guesses = line.start + line.step * nearest
        table = CurveTable("road map", 0.0, 1.0, np.column_stack([guesses, np.zeros(len(guesses))]))
        sizes = RunTimeNumbers("road map: sizes", [left, low, cell, rows])
        return _Map(table, _numbers(columns), _numbers(rows), sizes)

    def height(self, x: Any, y: Any) -> Any:
        """Return the height of the ground [m]."""
        u, v, _, _ = self.place(x, y)
        return self.on_line(u, v)

    def on_line(self, u: Any, v: Any) -> Any:
        """Return the height at a place along and beside the reference line [m]."""
        return self._smoothed(u, self.grid.value(u, v))[0]

    def gradient(self, x: Any, y: Any) -> tuple[Any, Any]:
        """Return the slopes along x and y [1]."""
        u, v, by_u, by_v = self.place(x, y)
        along, across = self.grid.slopes(u, v)
        _, scale, rate = self._smoothed(u, self.grid.value(u, v))
        along, across = scale * along + rate, scale * across
        return along * by_u[0] + across * by_v[0], along * by_u[1] + across * by_v[1]

    def place(self, x: Any, y: Any) -> tuple[Any, Any, Any, Any]:
        """Return u and v with their gradients in the world."""
        if self.is_straight:
            return self._beside_straight(x, y)
        of_x, of_y = self._curve
        u = self._guess(x, y)
        for _ in range(_STEPS):
            dx, dy = x - of_x.value(u), y - of_y.value(u)
            tx, ty = of_x.slope(u), of_y.slope(u)
            bend = dx * of_x.curvature(u) + dy * of_y.curvature(u)
            u = u + (dx * tx + dy * ty) / _positive(tx * tx + ty * ty, bend)
        dx, dy = x - of_x.value(u), y - of_y.value(u)
        tx, ty = of_x.slope(u), of_y.slope(u)
        speed = ops.sqrt(tx * tx + ty * ty)
        bend = dx * of_x.curvature(u) + dy * of_y.curvature(u)
        stretch = _positive(tx * tx + ty * ty, bend)
        v = (dy * tx - dx * ty) / speed
        return u, v, (tx / stretch, ty / stretch), (-ty / speed, tx / speed)

    @cached_property
    def _direction(self) -> RunTimeNumbers:
        """Where a straight line begins in the world and along it [m], and cosine and sine."""
        line = self.road.line
        along, beside = float(line.x[-1] - line.x[0]), float(line.y[-1] - line.y[0])
        length = math.hypot(along, beside)
        begin = line.x[0], line.y[0], line.start
        return RunTimeNumbers("road line: direction", [*begin, along / length, beside / length])

    def _beside_straight(self, x: Any, y: Any) -> tuple[Any, Any, Any, Any]:
        """Return u and v with their gradients beside a straight line."""
        first_x, first_y, start, cosine, sine = self._direction.at(x, y)
        dx, dy = x - first_x, y - first_y
        u = start + dx * cosine + dy * sine
        return u, dy * cosine - dx * sine, (cosine, sine), (-sine, cosine)

    def _guess(self, x: Any, y: Any) -> Any:
        of = self._map
        left, low, cell, rows = of.sizes.at(x, y)
        column = of.columns.value((x - left) / cell)
        row = of.rows.value((y - low) / cell)
        return of.guesses.value(column * rows + row + 0.5)

    @cached_property
    def _ends(self) -> RunTimeNumbers:
        """Start and stop of the line, lengths of the zones at its ends, heights there [m]."""
        road, line = self.road, self.road.line
        rise = [road.rise] * 2 if isinstance(road.rise, float) else [road.rise[0], road.rise[-1]]
        zones = road.borders.smooth_start, road.borders.smooth_end
        return RunTimeNumbers("road: ends", [line.start, line.stop, *zones, *rise])

    def _smoothed(self, u: Any, height: Any) -> tuple[Any, Any, Any]:
        """Return a height led to the ends of the road, its scale, and its own slope along u."""
        borders, scale, rate = self.road.borders, 1.0, 0.0
        zones = borders.smooth_start, borders.smooth_end
        if not any(zone > 0.0 for zone in zones):
            return height, scale, rate
        start, stop, *sizes = self._ends.at(u)
        for here, zone, into, sense, base in (
            (zones[0] > 0.0, sizes[0], u - start, 1.0, sizes[2]),
            (zones[1] > 0.0, sizes[1], stop - u, -1.0, sizes[3]),
        ):
            if here:
                share = ops.minimum(ops.maximum(into / zone, 0.0), 1.0)
                turns = ops.where(ops.logic_and(into >= 0.0, into < zone), sense / zone, 0.0)
                scale, rate = scale * share, rate * share + (height - base) * turns
                height = base + (height - base) * share
        return height, scale, rate


def check_borders(road: CrgRoad) -> None:
    """Refuse borders that ground for wheels cannot have.

    Raises
    ------
    InputError
        If a border repeats, reflects or is zero.
    """
    for axis, border in (("u", road.borders.u), ("v", road.borders.v)):
        if border not in (Border.KEEP, Border.NONE):
            raise InputError(
                f"border_mode_{axis} = {int(border)}: for driving only 2 (the last height goes "
                "on) is possible"
            )


def _positive(square: Any, bend: Any) -> Any:
    """Return the divisor of a Newton step, kept away from the centre of curvature."""
    return ops.maximum(square - bend, 0.1 * square)


def _numbers(count: int) -> CurveTable:
    """Return a table of the number of a cell; outside, of the first or last one."""
    numbers = np.arange(count, dtype=float)
    return CurveTable("cells", 0.0, 1.0, np.column_stack([numbers, np.zeros(count)]))
