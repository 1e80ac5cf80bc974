"""Exact percentiles of values that are read block by block, in bounded memory."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
_Keys = NDArray[np.uint64]

_DIGIT = 16
"""Bits of a number that one pass over the values settles."""
_SIGN = np.uint64(1 << 63)


def percentiles(
    blocks: Callable[[], Iterable[Floats]], count: int, wanted: Sequence[float]
) -> list[float]:
    """Return percentiles, linear between two values as NumPy's.

    Parameters
    ----------
    blocks
        Function that gives the values anew for each of four passes; none may be NaN.
    count
        Number of the values, one at least.
    wanted
        Percentiles [%].
    """
    places = [0.01 * one * (count - 1) for one in wanted]
    lower = [int(np.floor(place)) for place in places]
    ranks = sorted({rank for k in lower for rank in (k, min(k + 1, count - 1))})
    known = dict(zip(ranks, _ranked(blocks, ranks), strict=True))
    found = []
    for place, k in zip(places, lower, strict=True):
        low, high, part = known[k], known[min(k + 1, count - 1)], place - k
        found.append(low + (high - low) * part)
    return found


def _ranked(blocks: Callable[[], Iterable[Floats]], ranks: Sequence[int]) -> list[float]:
    """Return the values of some ranks, found digit by digit of their binary form."""
    rests, prefixes = list(ranks), [0] * len(ranks)
    for shift in range(64 - _DIGIT, -1, -_DIGIT):
        counts = {prefix: np.zeros(1 << _DIGIT, dtype=np.int64) for prefix in prefixes}
        for values in blocks():
            keys = _rising(values) >> np.uint64(shift)
            leading = keys >> np.uint64(_DIGIT)
            for prefix in counts:
                digits = (keys[leading == np.uint64(prefix)] & np.uint64(0xFFFF)).astype(np.int64)
                counts[prefix] += np.bincount(digits, minlength=1 << _DIGIT)
        for number, prefix in enumerate(prefixes):
            total = np.cumsum(counts[prefix])
            digit = int(np.searchsorted(total, rests[number], side="right"))
            rests[number] -= int(total[digit - 1]) if digit else 0
            prefixes[number] = (prefix << _DIGIT) + digit
    return [_number(prefix) for prefix in prefixes]


def _rising(values: Floats) -> _Keys:
    """Return whole numbers in the order of the values."""
    bits = np.ascontiguousarray(values, dtype=np.float64).view(np.uint64)
    return np.where(bits & _SIGN, ~bits, bits | _SIGN)


def _number(key: int) -> float:
    """Return the value of a whole number of :func:`_rising`."""
    bits = np.uint64(key)
    own = bits & ~_SIGN if bits & _SIGN else ~bits
    return float(np.array([own], dtype=np.uint64).view(np.float64)[0])
