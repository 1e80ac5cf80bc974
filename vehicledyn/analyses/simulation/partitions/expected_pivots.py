"""What pivots of loops are expected to be at a look, by those at the looks before."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.kernel.engine import WEAK_PIVOT

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]

HARMLESS = 0.5
"""Product of all such parts below which the leverage is looked at: swapping two coordinates
multiplies the determinant by an entry of the leverage."""
_FORESEEN = 0.4
"""Part of the largest determinant met below which it is expected at a look if it goes on as between
the two before, and which is looked at by itself then."""
_SUDDEN = 0.2
"""Part of the largest determinant met by which one may differ from what is expected of it."""
_STEADY = 0.95
"""Part of the largest determinant met above which none has been near to zero."""
_SHORTEST = 1e-12
"""Shortest time between two looks [s]."""


class LastLook(NamedTuple):
    """The look before: time [s], pivots, about their rates [1/s], and the largest sizes so far."""

    time: float
    pivots: Vector
    rates: Vector
    scale: Vector

    def then(self, times: Vector, values: Matrix) -> LastLook:
        """Return the last of further looks, pivots one row each."""
        before = np.vstack([self.pivots, values])[-2]
        span = max(times[-1] - np.append(self.time, times)[-2], _SHORTEST)
        scale = np.maximum(self.scale, np.abs(values).max(axis=0))
        return LastLook(float(times[-1]), values[-1], (values[-1] - before) / span, scale)


def are_harmless(times: Vector, values: Matrix, last: LastLook) -> Any:
    """Return at which looks no pivot is weak or changes its sign, or is not what is expected.

    ``values`` (n_looks, n_pivots) follow those of the ``last`` look.
    """
    if _hardly_change(values, last):
        return np.ones(len(values), dtype=bool)
    sizes = np.abs(values)
    largest = np.maximum(np.maximum.accumulate(sizes, axis=0), last.scale)
    before = np.vstack([last.pivots, values[:-1]])
    parts = sizes / np.where(largest > 0.0, largest, 1.0)
    harmless = (parts >= WEAK_PIVOT).all(axis=1) & (values * before > 0.0).all(axis=1)
    harmless &= parts.prod(axis=1) >= HARMLESS
    spans = np.maximum(np.diff(times, prepend=last.time), _SHORTEST)[:, None]
    rates = np.vstack([last.rates, (values - before)[:-1] / spans[:-1]])
    expected = before + rates * spans
    harmless &= (expected * np.sign(before) >= _FORESEEN * largest).all(axis=1)
    return harmless & (np.abs(values - expected) <= _SUDDEN * largest).all(axis=1)


def _hardly_change(values: Matrix, last: LastLook) -> bool:
    """Return whether all pivots stay near the largest so far, which is quickly found out."""
    ends = np.array([values.min(axis=0), values.max(axis=0)])
    largest = np.maximum(np.abs(ends).max(axis=0), last.scale)
    least = (ends * np.sign(last.pivots) / np.where(largest > 0.0, largest, 1.0)).min(axis=0)
    return bool((least >= _STEADY).all() and least.prod() >= HARMLESS)


def unlikely(
    time: float, values: Vector, last: LastLook, rates: Callable[[], tuple[Vector, Vector]]
) -> list[int]:
    """Return the pivots that may have been zero since the last look, though they keep their sign.

    Those fall at the last look and rise at this, and the tangents meet low; or they are elsewhere
    than their rates lead. ``rates`` gives the rates at both looks [1/s].
    """
    span, before = time - last.time, last.pivots
    largest = np.maximum(last.scale, np.abs(values))
    expected = before + last.rates * span
    low = expected * np.sign(before) < _FORESEEN * largest
    sudden = np.abs(values - expected) > _SUDDEN * largest
    if not (low | sudden).any():
        return []
    first, now = rates()
    sudden &= np.abs(values - before - 0.5 * span * (first + now)) > _SUDDEN * largest
    fall, rise, size = -first * np.sign(before), now * np.sign(before), np.abs(before)
    both = np.where((fall > 0.0) & (rise > 0.0), fall + rise, np.inf)
    least = size - fall * (size - np.abs(values) + rise * span) / both
    low &= (both < np.inf) & (least < WEAK_PIVOT * largest)
    return [int(k) for k in np.flatnonzero(low | sudden)]
