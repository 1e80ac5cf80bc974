"""Surfaces through heights on a square grid, with continuous slope in every direction."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.grids.run_time_numbers import RunTimeNumbers
from vehicledyn.symbolic.tables import Array, CurveTable


@dataclass(frozen=True, eq=False)
class BicubicGrid:
    """A surface z(x, y) by bicubic convolution (Catmull and Rom); exact for quadratics.

    Beyond the grid it keeps the value at its edge. Between nodes it may swing out by an eighth
    of a jump of height. The methods take and return floats or expressions.

    Parameters
    ----------
    name
        What the surface is, for messages.
    x, y
        First place along either axis.
    step
        Distance of the nodes, positive.
    values
        Shape (n_x, n_y), finite, at least two each way.

    References
    ----------
    R.G. Keys, Cubic convolution interpolation for digital image processing, IEEE Transactions
    on Acoustics, Speech and Signal Processing 29 (1981), 1153-1160, with a = -1/2.
    """

    name: str
    x: float
    y: float
    step: float
    values: Array

    @cached_property
    def _lines(self) -> CurveTable:
        """All curves along x, one after the other; each ends with a level cell."""
        before = 2.0 * self.values[:1] - self.values[1:2]
        after = 2.0 * self.values[-1:] - self.values[-2:-1]
        padded = np.concatenate([before, self.values, after])
        slopes = 0.5 * (padded[2:] - padded[:-2])
        rises, first, last = np.diff(self.values, axis=0), slopes[:-1], slopes[1:]
        cubic = np.stack(
            [self.values[:-1], first, 3.0 * rises - 2.0 * first - last, first + last - 2.0 * rises],
            axis=-1,
        )
        level = np.zeros((1, self.values.shape[1], 4))
        level[0, :, 0] = self.values[-1]
        rows = np.concatenate([cubic, level]).swapaxes(0, 1).reshape(-1, 4)
        return CurveTable(self.name, 0.0, 1.0, rows)

    @cached_property
    def _numbers(self) -> CurveTable:
        """Number of the cell across at a place counted in cells."""
        numbers = np.arange(self.values.shape[1] - 1, dtype=float)
        rows = np.column_stack([numbers, np.zeros_like(numbers)])
        return CurveTable(f"{self.name}: lines", 0.0, 1.0, rows)

    def steepest(self) -> tuple[float, float, float]:
        """Return the largest slope between neighbouring nodes, and the place halfway, x and y."""
        along, across = (np.abs(np.diff(self.values, axis=axis)) for axis in (0, 1))
        axis = int(across.max() > along.max())
        rises = across if axis else along
        place = np.array(np.unravel_index(int(np.argmax(rises)), rises.shape), dtype=float)
        place[axis] += 0.5
        x, y = np.array([self.x, self.y]) + self.step * place
        return float(rises.max()) / self.step, float(x), float(y)

    def covers(self, x: Array, y: Array) -> NDArray[np.bool_]:
        """Return whether places lie on the grid."""
        far_x, far_y = (
            first + self.step * (count - 1)
            for first, count in zip((self.x, self.y), self.values.shape, strict=True)
        )
        return np.asarray((x >= self.x) & (x <= far_x) & (y >= self.y) & (y <= far_y))

    def value(self, x: Any, y: Any) -> Any:
        """Return the height at a place."""
        place, lines, share, _, _ = self._place(x, y)
        heights = self._four([self._lines.value(line + place) for line in lines], lines)
        return _sum(_weights(share), heights)

    def slopes(self, x: Any, y: Any) -> tuple[Any, Any]:
        """Return the slopes along x and y."""
        place, lines, share, into_x, into_y = self._place(x, y)
        heights = self._four([self._lines.value(line + place) for line in lines], lines)
        along = self._four([self._lines.slope(line + place) for line in lines], lines)
        across = _sum(_slopes_of_weights(share), heights)
        return _sum(_weights(share), along) * into_x, across * into_y

    @cached_property
    def _sizes(self) -> RunTimeNumbers:
        """First places, step and counts, which compiled code looks up."""
        count, wide = self.values.shape
        return RunTimeNumbers(
            f"{self.name}: sizes", [self.x, self.y, self.step, count, count - 1, wide - 1]
        )

    def _place(self, x: Any, y: Any) -> tuple[Any, list[Any], Any, Any, Any]:
        """Return place along, the four lines beside it, share across, rates by x and y."""
        first_x, first_y, step, count, end, last = self._sizes.at(x, y)
        along, in_x = _held((x - first_x) / step, end)
        across, in_y = _held((y - first_y) / step, last)
        number = self._numbers.value(across)
        lines = [ops.minimum(ops.maximum(number + n, 0.0), last) * count for n in _BESIDE]
        return along, lines, across - number, in_x / step, in_y / step

    def _four(self, found: list[Any], lines: list[Any]) -> list[Any]:
        """Return four values across; beyond the outermost line the curve goes on straight."""
        before, low, high, after = found
        before = ops.where(lines[0] < lines[1], before, 2.0 * low - high)
        after = ops.where(lines[3] > lines[2], after, 2.0 * high - low)
        return [before, low, high, after]


_BESIDE = (-1.0, 0.0, 1.0, 2.0)


def _held(place: Any, last: Any) -> tuple[Any, Any]:
    """Return a place kept on the grid, and its rate: 1 inside, 0 outside."""
    inside = ops.where(ops.logic_and(place >= 0.0, place < last), 1.0, 0.0)
    return ops.minimum(ops.maximum(place, 0.0), last), inside


def _weights(t: Any) -> tuple[Any, ...]:
    return (
        t * (-0.5 + t * (1.0 - 0.5 * t)),
        1.0 + t * t * (-2.5 + 1.5 * t),
        t * (0.5 + t * (2.0 - 1.5 * t)),
        t * t * (-0.5 + 0.5 * t),
    )


def _slopes_of_weights(t: Any) -> tuple[Any, ...]:
    return (
        -0.5 + t * (2.0 - 1.5 * t),
        t * (-5.0 + 4.5 * t),
        0.5 + t * (4.0 - 4.5 * t),
        t * (-1.0 + 1.5 * t),
    )


def _sum(weights: tuple[Any, ...], values: list[Any]) -> Any:
    terms = [weight * value for weight, value in zip(weights, values, strict=True)]
    return terms[0] + terms[1] + terms[2] + terms[3]
