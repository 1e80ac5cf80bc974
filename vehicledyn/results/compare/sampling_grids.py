"""Whether two runs cover the same time and were sampled at the same instants."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from vehicledyn.results.store.column import StoredColumn
from vehicledyn.results.store.decimation import PORTION

Floats = NDArray[np.float64]

SAME_INSTANT = 1e-9  # share of the smallest sampling step by which equal times may differ


def range_difference(result: StoredColumn, reference: StoredColumn) -> str:
    """Return how a result falls short of the reference's time range, empty if it does not.

    Both arguments are rising times [s] with at least one sample.
    """
    slack = _slack(reference)
    (begin, end), (first, last) = _ends(result), _ends(reference)
    if end < last - slack:
        return f"the result ends at t = {end:.9g} s, the reference at {last:.9g} s"
    if begin > first + slack:
        return f"the result starts at t = {begin:.9g} s, the reference at {first:.9g} s"
    return ""


def grid_difference(result: StoredColumn, reference: StoredColumn) -> str:
    """Return how the sample times differ, empty if they are equal but for rounding."""
    advice = "ask for interpolation to compare them all the same"
    if len(result) != len(reference):
        return f"{len(result)} samples, the reference has {len(reference)}; {advice}"
    at, most = 0, 0.0
    for start in range(0, len(result), PORTION):
        apart = np.abs(result[start : start + PORTION] - reference[start : start + PORTION])
        worst = int(np.argmax(apart))
        if apart[worst] > most:
            at, most = start + worst, float(apart[worst])
    if most > _slack(reference):
        own, wanted = (float(column[at : at + 1][0]) for column in (result, reference))
        return (
            f"sample {at} lies at t = {own:.12g} s, in the reference at {wanted:.12g} s; {advice}"
        )
    return ""


class Resampling:
    """Values of columns at other times, linear between samples and read block by block."""

    def __init__(self, times: StoredColumn) -> None:
        self._times = times
        starts = range(0, len(times), PORTION)
        self._starts = np.array([float(times[k : k + 1][0]) for k in starts])

    def values(self, column: StoredColumn, wanted: Floats) -> Floats:
        """Return a column at rising times [s], shape (n,)."""
        first = max(int(np.searchsorted(self._starts, wanted[0])) - 1, 0)
        last = int(np.searchsorted(self._starts, wanted[-1], side="right")) + 1
        part = slice(first * PORTION, last * PORTION)
        return np.asarray(np.interp(wanted, self._times[part], column[part]))


def _ends(times: StoredColumn) -> tuple[float, float]:
    count = len(times)
    return float(times[0:1][0]), float(times[count - 1 : count][0])


def _slack(reference: StoredColumn) -> float:
    smallest = min(_smallest_steps(reference), default=math.inf)
    return SAME_INSTANT * smallest if math.isfinite(smallest) else 0.0


def _smallest_steps(times: StoredColumn) -> Iterator[float]:
    for start in range(0, len(times), PORTION):
        steps = np.diff(times[start : start + PORTION + 1])
        yield float(np.min(steps[steps > 0.0], initial=np.inf))
