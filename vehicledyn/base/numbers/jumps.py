"""Integrals of samples of a function that jumps at known places."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from vehicledyn.base.numbers.spline import spline_integral

Vector = NDArray[np.float64]

_NEAR = 4
"""Samples of a side whose cubic is followed up to a jump."""
_BESIDE = 1e-6
"""Part of an interval by which a sample stands beside a jump, else its side is uncertain."""


def jumping_integral(
    places: Vector, values: Vector, jumps: Sequence[float], expected: Vector
) -> Vector:
    """Return the integral from the first place to each of a function that may jump, shape (n,).

    Between jumps it is that of a spline, and up to them that of the cubic through the next samples.
    What samples leave open there, by as much as parabolas differ, is taken as expected. Of several
    jumps between two samples the first counts.

    Parameters
    ----------
    places
        Increasing places of at least two samples, shape (n,).
    values
        Values there, shape (n,). One at a jump is of the side whose curve it continues.
    jumps
        Where the function may jump.
    expected
        What the integral up to each place is to be compared with, shape (n,).
    """
    inside = np.array(sorted(jump for jump in set(jumps) if places[0] <= jump < places[-1]))
    if not inside.size:
        return spline_integral(places, values)
    after, begun = np.unique(_behind(places, values, inside), return_index=True)
    edges = sorted({0, len(values), *map(int, after)})
    where = dict(zip(map(int, after), map(float, inside[begun]), strict=True))
    found = np.zeros(len(values))
    for first, last in pairwise(edges):
        if first:
            step = expected[first] - expected[first - 1]
            sides = slice(max(0, first - _NEAR), first), slice(first, min(first + _NEAR, last))
            made = _over(where[first], [(places[side], values[side]) for side in sides])
            found[first] = found[first - 1] + np.clip(step, *made)
        if last > first + 1:
            found[first:last] = found[first] + spline_integral(
                places[first:last], values[first:last]
            )
    return found


def _over(jump: float, sides: Sequence[tuple[Vector, Vector]]) -> tuple[float, float]:
    """Return between what the integral lies from the last sample before a jump to the next one."""
    (before, low), (behind, high) = sides
    cubic = _followed(before, low, before[-1], jump) + _followed(behind, high, jump, behind[0])
    plain = _followed(before[1:], low[1:], before[-1], jump) + _followed(
        behind[:-1], high[:-1], jump, behind[0]
    )
    return cubic - abs(cubic - plain), cubic + abs(cubic - plain)


def _behind(places: Vector, values: Vector, inside: Vector) -> NDArray[np.intp]:
    """Return the first sample behind each jump."""
    least = _BESIDE * float(np.diff(places).min())
    after = np.searchsorted(places, inside - least)
    edges = np.concatenate([[0], after, [len(values)]])
    for number, index in enumerate(after.tolist(), 1):
        if abs(places[index] - inside[number - 1]) > least:
            continue
        before = slice(max(int(edges[number - 1]), index - _NEAR), index)
        behind = slice(index + 1, min(int(edges[number + 1]), index + 1 + _NEAR))
        misses = [
            abs(float(_curve(places[near], values[near])(places[index])) - values[index])
            if places[near].size
            else np.inf
            for near in (before, behind)
        ]
        after[number - 1] = index + (misses[0] < misses[1])
    return np.asarray(after, dtype=np.intp)


def _curve(places: Vector, values: Vector) -> Polynomial:
    """Return the polynomial through some samples."""
    if len(places) < 2:
        return Polynomial(values if len(values) else [0.0])
    return Polynomial.fit(places, values, len(places) - 1)


def _followed(places: Vector, values: Vector, begin: float, end: float) -> float:
    """Return the integral of the polynomial through some samples over an interval."""
    whole = _curve(places, values).integ()
    return float(whole(end) - whole(begin))
