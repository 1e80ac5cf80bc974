"""Points of a profile in the order of y: noise that goes back, ends that fold, loops.

Noise along y takes points back where they are close to each other, or the profile is steep. How
far noise may go is estimated from the points, and neighbours out of order are replaced by their
mean: the increasing sequence closest to the points, found by pooling adjacent violators.

References
----------
Robertson, Wright and Dykstra (1988), Order Restricted Statistical Inference, section 1.2.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.rail.profiles.profile import STEEPEST
from vehicledyn.rail.profiles.profile_pieces import Floats
from vehicledyn.rail.profiles.profile_points import RawPoints

_SWAPPED = 2  # segments apart: two points in the wrong order, no loop
_NOISE, _MOST_NOISE, _OF_NOISE = 50e-6, 2e-3, 8.0
"""Steps back of y that are always and never noise [m]; between, in standard deviations of y [1]."""

_SECOND = 1.4826 / np.sqrt(6.0)
"""Standard deviation of noise by the median of the size of its second differences [1]."""

_UPRIGHT = 0.3e-3
"""Width of an end that goes up and down within it, as the back of a flange does [m]."""

Lines = NDArray[np.int_]


class Ordered(NamedTuple):
    """Points whose y grows, their lines, the points that means stand for (k, 2), and notes."""

    y: Floats
    z: Floats
    lines: Lines
    averaged: Floats
    notes: list[str]


def put_in_order(points: RawPoints, y: Floats, z: Floats, lines: Lines) -> Ordered:
    """Return points whose y grows, with their lines and what was done.

    Upright ends that noise makes fold are left out; neighbours that noise puts out of order are
    replaced by their mean; ends that fold back, as under the head of a rail, are cut off.

    Raises
    ------
    InputError
        If the profile crosses itself, or turns back elsewhere than at its ends.
    """
    notes = []
    kept = _without_upright_ends(y, z)
    if len(y) > kept.stop - kept.start:
        cut = len(y) - (kept.stop - kept.start)
        notes.append(f"{cut} points of an upright end left out: y goes back and forth there")
    y, z, lines = y[kept], z[kept], lines[kept]
    noise = _noise(y)
    y, z, lines, averaged, said = _averaged(y, z, lines, noise)
    _check_order(points, y, z, lines, noise)
    first, last = _ends(y)
    cut = len(y) - (last + 1 - first)
    if cut:
        said.append(f"{cut} points cut off at the ends, where the profile folds back")
    visible = slice(first, last + 1)
    return Ordered(y[visible], z[visible], lines[visible], averaged, notes + said)


def _without_upright_ends(y: Floats, z: Floats) -> slice:
    """Return the points between ends so steep that noise makes them fold."""
    begin, end = 0, len(y)
    low, high = np.flatnonzero(y < y.min() + _UPRIGHT), np.flatnonzero(y > y.max() - _UPRIGHT)
    if _folds(y, z, low):
        begin = int(low[-1])
    if _folds(y, z, high):
        end = int(high[0]) + 1
    return slice(begin, end) if begin + 2 < end else slice(0, len(y))


def _folds(y: Floats, z: Floats, band: NDArray[np.intp]) -> bool:
    """Return whether the points of an end lie beside each other, go back, and rise steeply."""
    if len(band) < 3 or band[-1] - band[0] > len(band) - 1:
        return False
    rise = abs(float(z[band[-1]] - z[band[0]]))
    steps = np.diff(y[band])
    return rise > STEEPEST * _UPRIGHT and bool((steps < 0.0).any() and (steps > 0.0).any())


def _noise(y: Floats) -> float:
    """Return how far noise may take y back [m]."""
    if len(y) < 3:
        return _NOISE
    deviation = _SECOND * float(np.median(np.abs(np.diff(y, 2))))
    return float(np.clip(_OF_NOISE * deviation, _NOISE, _MOST_NOISE))


def _averaged(y: Floats, z: Floats, lines: Lines, noise: float) -> Ordered:
    """Return points with neighbours that noise puts out of order replaced by their mean.

    Nothing is replaced where y goes back by more than noise does.
    """
    first, last = _ends(y)
    inner = y[first : last + 1]
    furthest = np.maximum.accumulate(inner)
    back = (furthest - inner)[1:]
    none = np.zeros((0, 2))
    if not len(back) or not 0.0 <= back.max() <= noise or (np.diff(inner) > 0.0).all():
        return Ordered(y, z, lines, none, [])
    starts = first + _pools(inner)
    groups = np.concatenate([np.arange(first), starts, np.arange(last + 1, len(y))])
    counts = np.diff([*groups, len(y)])
    means = [np.add.reduceat(values, groups) / counts for values in (y, z)]
    several = np.repeat(counts > 1, counts)
    note = (
        f"{int(several.sum())} points averaged to {int((counts > 1).sum())} where y goes back, by "
        f"up to {1e6 * float(back.max()):.3g} µm"
    )
    averaged = np.column_stack([y, z])[several]
    return Ordered(means[0], means[1], lines[groups], averaged, [note])


def _pools(values: Floats) -> NDArray[np.intp]:
    """Return where groups of neighbours begin whose means increase, the closest to the values."""
    sums: list[float] = []
    counts: list[int] = []
    for value in values.tolist():
        sums.append(value)
        counts.append(1)
        while len(sums) > 1 and sums[-2] / counts[-2] >= sums[-1] / counts[-1]:
            total, count = sums.pop(), counts.pop()
            sums[-1] += total
            counts[-1] += count
    return np.concatenate([[0], np.cumsum(counts[:-1])]).astype(np.intp)


def _check_order(points: RawPoints, y: Floats, z: Floats, lines: Lines, noise: float) -> None:
    """Refuse a profile that crosses itself, or turns back elsewhere than at its ends."""
    crossing = _first_crossing(y, z, noise)
    if crossing is not None:
        message = (
            f"the profile crosses itself: a loop with the part at line {lines[crossing[0]]}; "
            "remove it, or sort the points"
        )
        raise points.refused(int(lines[crossing[1]]), 1, message)
    first, last = _ends(y)
    steps = np.diff(y[first : last + 1])
    if first > last or (steps <= 0.0).any():
        # Small steps back may be noise: the longest is the one to look at.
        k = first + int(np.argmin(steps)) + 1 if len(steps) else first
        message = (
            f"unsorted: y goes back from {y[k - 1] / points.unit:g} to {y[k] / points.unit:g}; "
            "give the points in their order along the profile"
        )
        raise points.refused(int(lines[k]), 1, message)


def _first_crossing(y: Floats, z: Floats, noise: float) -> tuple[int, int] | None:
    """Return two segments that cross, with a loop between wider than noise, or None."""
    begin, end = np.column_stack([y[:-1], z[:-1]]), np.column_stack([y[1:], z[1:]])
    low, high = np.minimum(begin[:, 0], end[:, 0]), np.maximum(begin[:, 0], end[:, 0])
    for k in range(len(begin) - 2):
        later = np.flatnonzero((low[k + 2 :] <= high[k]) & (high[k + 2 :] >= low[k])) + k + 2
        for other in later:
            wide = other - k > _SWAPPED and np.ptp(y[k : other + 2]) > noise
            if wide and _cross(begin[k], end[k], begin[other], end[other]):
                return k, int(other)
    return None


def _cross(a: Floats, b: Floats, c: Floats, d: Floats) -> bool:
    def side(p: Floats, q: Floats, r: Floats) -> float:
        return float((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))

    return side(a, b, c) * side(a, b, d) <= 0.0 and side(c, d, a) * side(c, d, b) <= 0.0


def _ends(y: Floats) -> tuple[int, int]:
    """Return where y is smallest and largest, next to the rest of the profile if upright there."""
    return len(y) - 1 - int(np.argmin(y[::-1])), int(np.argmax(y))
