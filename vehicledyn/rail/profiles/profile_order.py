"""Points of a profile in the order of y: noise that goes back, ends that fold, loops."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vehicledyn.rail.profiles.profile import STEEPEST
from vehicledyn.rail.profiles.profile_pieces import Floats
from vehicledyn.rail.profiles.profile_points import RawPoints

_SWAPPED = 2  # segments apart: two points in the wrong order, no loop
_NOISE = 50e-6
"""Steps back of y up to which they are noise of the measurement [m]."""

_UPRIGHT = 0.3e-3
"""Width of an end that goes up and down within it, as the back of a flange does [m]."""

Lines = NDArray[np.int_]


def put_in_order(
    points: RawPoints, y: Floats, z: Floats, lines: Lines
) -> tuple[Floats, Floats, Lines, list[str]]:
    """Return points whose y grows, with their lines and what was left out.

    Upright ends that noise makes fold, and points that noise takes back, are left out; ends that
    fold back, as under the head of a rail, are cut off.

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
    forward = _forward(y)
    if not forward.all():
        most = 1e6 * float(np.max((np.maximum.accumulate(y) - y)[~forward]))
        count = int((~forward).sum())
        notes.append(f"{count} points left out where y goes back, by up to {most:.3g} µm")
    y, z, lines = y[forward], z[forward], lines[forward]
    _check_order(points, y, z, lines)
    first, last = _ends(y)
    cut = len(y) - (last + 1 - first)
    if cut:
        notes.append(f"{cut} points cut off at the ends, where the profile folds back")
    visible = slice(first, last + 1)
    return y[visible], z[visible], lines[visible], notes


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


def _forward(y: Floats) -> NDArray[np.bool_]:
    """Return which points are not taken back by noise, between the smallest and largest y."""
    first, last = _ends(y)
    forward = np.ones(len(y), dtype=bool)
    furthest = y[first]
    for k in range(first + 1, last):
        if 0.0 <= furthest - y[k] <= _NOISE:
            forward[k] = False
        furthest = max(furthest, y[k])
    return forward


def _check_order(points: RawPoints, y: Floats, z: Floats, lines: Lines) -> None:
    """Refuse a profile that crosses itself, or turns back elsewhere than at its ends."""
    crossing = _first_crossing(y, z)
    if crossing is not None and crossing[1] - crossing[0] > _SWAPPED:
        message = (
            f"the profile crosses itself: a loop with the part at line {lines[crossing[0]]}; "
            "remove it, or sort the points"
        )
        raise points.refused(int(lines[crossing[1]]), 1, message)
    first, last = _ends(y)
    back = np.flatnonzero(np.diff(y[first : last + 1]) <= 0.0)
    if first > last or len(back):
        k = first + int(back[0]) + 1 if len(back) else first
        message = (
            f"unsorted: y goes back from {y[k - 1] / points.unit:g} to {y[k] / points.unit:g}; "
            "give the points in their order along the profile"
        )
        raise points.refused(int(lines[k]), 1, message)


def _first_crossing(y: Floats, z: Floats) -> tuple[int, int] | None:
    """Return two segments, not neighbours, that cross, or None."""
    begin, end = np.column_stack([y[:-1], z[:-1]]), np.column_stack([y[1:], z[1:]])
    low, high = np.minimum(begin[:, 0], end[:, 0]), np.maximum(begin[:, 0], end[:, 0])
    for k in range(len(begin) - 2):
        later = np.flatnonzero((low[k + 2 :] <= high[k]) & (high[k + 2 :] >= low[k])) + k + 2
        for other in later:
            if _cross(begin[k], end[k], begin[other], end[other]):
                return k, int(other)
    return None


def _cross(a: Floats, b: Floats, c: Floats, d: Floats) -> bool:
    def side(p: Floats, q: Floats, r: Floats) -> float:
        return float((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]))

    return side(a, b, c) * side(a, b, d) <= 0.0 and side(c, d, a) * side(c, d, b) <= 0.0


def _ends(y: Floats) -> tuple[int, int]:
    """Return where y is smallest and largest, next to the rest of the profile if upright there."""
    return len(y) - 1 - int(np.argmin(y[::-1])), int(np.argmax(y))
