"""Defects of measured profiles: points that do not belong to the curve, gaps and steps.

A run of up to six points begins and ends with outliers where a cubic through three points on either
side fits these well and misses both by far: by more than it misses the points it is fitted to, than
the points elsewhere scatter, and than 30 µm. Points between them are outliers if it misses them
too. A corner is none, as no cubic fits beside it. A patch
between two opposite steps is outliers too, however many points it has. A gap is a stretch without
points ten times as long as is usual in the file.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from vehicledyn.rail.profiles.fitted_cubics import fit_cubics, powers
from vehicledyn.rail.profiles.profile import STEEPEST
from vehicledyn.rail.profiles.profile_pieces import Floats
from vehicledyn.rail.profiles.profile_steps import ProfileStep, find_patches, find_steps

LONGEST_RUN = 6
MOST_OUTLIERS = 0.1
"""Share of outliers beyond which points are no profile [1]."""

_BESIDE = 6
"""Points that a run is compared with, half of them on either side where there are as many."""

_LEAST = 30e-6
_OF_SCATTER, _OF_FIT = 12.0, 8.0
_GAP, _OF_SPACING, _OF_NEIGHBOURS = 4e-3, 10.0, 3.0
_LONGEST, _SPACINGS = 4.5e-3, 3.0
"""Longest run, and in spacings where these are wider: beyond it the profile itself bends."""

_AROUND = 41
"""Points of which the scatter around one is the median."""

_PASSES = 50
_TINY = 1e-24

Places = NDArray[np.int_]


@dataclass(frozen=True)
class Defects:
    """Outliers by their number, with their distance from the curve [m], gaps and steps.

    A gap is the number of the point before it, counted among all points, as are the numbers of
    steps; ``in_patches`` are the outliers between two opposite steps. Steps are those that bound
    no patch.
    """

    outliers: dict[int, float]
    gaps: tuple[int, ...]
    scatter: float
    steps: tuple[ProfileStep, ...] = ()
    in_patches: frozenset[int] = frozenset()


def find_defects(points: Floats) -> Defects:
    """Return the defects of points in their order along a profile.

    Parameters
    ----------
    points
        y and z, shape (n, 2) [m].
    """
    # Patches come first: points at their edges look like outliers.
    patched = _patched(points, np.arange(len(points)))
    found = _stray(points) | patched
    left = _others(found, len(points))
    for _ in range(_PASSES):
        fresh = _outliers(points[left])
        if not fresh:
            break
        found |= {int(left[k]): distance for k, distance in fresh.items()}
        left = _others(found, len(points))
    hidden = _patched(points, left)
    patched |= hidden
    found |= hidden
    left = _others(found, len(points))
    kept = points[left]
    gaps = tuple(int(left[k]) for k in _gaps(kept))
    steps = tuple(
        ProfileStep(int(left[step.before]), int(left[step.behind]), step.height)
        for step in _steps(kept)
    )
    outliers = dict(sorted(found.items()))
    return Defects(outliers, gaps, find_scatter(kept), steps, frozenset(patched))


def _others(found: dict[int, float], count: int) -> Places:
    """Return the numbers of the points that are not found."""
    return np.array([k for k in range(count) if k not in found], dtype=int)


def _patched(points: Floats, left: Places) -> dict[int, float]:
    """Return the points of patches among those left, with the height of the patch."""
    found: dict[int, float] = {}
    for first, last in find_patches(_steps(points[left]), len(left)):
        size = 0.5 * (abs(first.height) + abs(last.height))
        found |= {int(k): size for k in left[first.before + 1 : last.behind]}
    return found


def _steps(points: Floats) -> list[ProfileStep]:
    """Return the steps of points between gaps."""
    scatter = find_scatter(points)
    found = []
    for part in _parts(points):
        begin = int(part[0])
        for step in find_steps(points[part], scatter):
            found.append(ProfileStep(begin + step.before, begin + step.behind, step.height))
    return found


def _spacing(points: Floats) -> Floats:
    return np.asarray(np.hypot(*np.diff(points, axis=0).T))


def _widest(points: Floats) -> float:
    """Return the distance of neighbours beyond which points are missing [m]."""
    return max(_GAP, _OF_SPACING * float(np.median(_spacing(points))))


def _breaks(points: Floats) -> Places:
    """Return the points that are far from the next one, in any direction."""
    return np.flatnonzero(_spacing(points) > _widest(points))


def _gaps(points: Floats) -> Places:
    """Return the points before gaps; upright sides and evenly wide parts have none.

    Evenly wide is along the profile and across: points evenly spaced in y are far apart where the
    profile is steep.
    """
    spacing = _spacing(points)
    across, up = np.abs(np.diff(points, axis=0)).T
    wide = (spacing > _widest(points)) & (spacing > _OF_NEIGHBOURS * _beside(spacing))
    wide &= across > _OF_NEIGHBOURS * _beside(across)
    return np.flatnonzero(wide & (up < STEEPEST * across))


def _beside(values: Floats) -> Floats:
    """Return the larger of both neighbours of each value."""
    padded = np.pad(values, 1)
    return np.asarray(np.maximum(padded[:-2], padded[2:]))


def _stray(points: Floats) -> dict[int, float]:
    """Return few points that lie far from both neighbours, which are close to each other."""
    widest = _widest(points)
    found: dict[int, float] = {}
    for before, behind in pairwise(_breaks(points).tolist()):
        apart = float(np.hypot(*(points[behind + 1] - points[before])))
        if behind - before <= LONGEST_RUN and apart < widest:
            middle = 0.5 * (points[before] + points[behind + 1])
            for k in range(before + 1, behind + 1):
                found[int(k)] = float(np.hypot(*(points[k] - middle)))
    return found


def _parts(points: Floats) -> list[Places]:
    """Return the numbers of points between gaps, where there are enough of them."""
    edges = [0, *(_breaks(points) + 1), len(points)]
    return [np.arange(a, b) for a, b in pairwise(edges) if b - a > _BESIDE]


def find_scatter(points: Floats) -> float:
    """Return how far a point lies from the curve through those around it, in the median [m].

    Parameters
    ----------
    points
        y and z in their order along the profile, shape (n, 2) [m].
    """
    distances = [_missed(points[part], 1)[0][:, 0] for part in _parts(points)]
    return float(np.median(np.concatenate(distances))) if distances else 0.0


def _scatter_around(points: Floats) -> Floats:
    """Return the scatter around each point but the ends, shape (n - 2,) [m].

    Noise along y shows across the curve only where the profile is steep.
    """
    from scipy.ndimage import median_filter

    distances = _missed(points, 1)[0][:, 0]
    return np.asarray(median_filter(distances, size=min(_AROUND, len(distances)), mode="reflect"))


def _outliers(points: Floats) -> dict[int, float]:
    """Return the clearest outliers that are not beside each other, with their distances."""
    scatter = find_scatter(points)
    candidates: list[tuple[float, Places, Floats]] = []
    for part in _parts(points):
        local = np.maximum(scatter, _scatter_around(points[part]))
        for length in range(1, LONGEST_RUN + 1):
            if len(part) < length + _BESIDE:
                continue
            distances, fit = _missed(points[part], length)
            middle = slice(length // 2, length // 2 + len(fit))
            least = np.maximum(_LEAST, _OF_SCATTER * local[middle])
            limit = np.maximum(least, _OF_FIT * fit)
            beyond = distances > limit[:, None]
            # Good points may lie between two outliers, but the run begins and ends with one.
            for k in np.flatnonzero(beyond[:, 0] & beyond[:, -1] & _testable(points[part], length)):
                far = distances[k][beyond[k]]
                ratio = float(far.min() / limit[k]) / length
                run = part[k + 1 : k + 1 + length][beyond[k]]
                candidates.append((ratio, run, far))
    found: dict[int, float] = {}
    taken = np.zeros(len(points), dtype=bool)
    for _, run, distances in sorted(candidates, key=lambda item: -item[0]):
        around = slice(max(int(run[0]) - _BESIDE, 0), int(run[-1]) + _BESIDE + 1)
        if not taken[around].any():
            taken[run] = True
            found |= {int(k): float(d) for k, d in zip(run, distances, strict=True)}
    return found


def _testable(points: Floats, length: int) -> NDArray[np.bool_]:
    """Return which runs are short and have enough points on either side to be compared with."""
    first = np.arange(1, len(points) - length)
    behind = len(points) - first - length
    wanted = min(length + 1, _BESIDE // 2)
    chord = np.hypot(*(points[first + length] - points[first - 1]).T)
    longest = max(_LONGEST, _SPACINGS * float(np.median(_spacing(points))))
    return np.asarray((first >= wanted) & (behind >= wanted) & (chord < longest))


def _missed(points: Floats, length: int) -> tuple[Floats, Floats]:
    """Return how far cubics through the points around runs miss these, and their own points.

    Returns
    -------
    tuple of arrays
        Distances of the points of each run, shape (n_runs, length), and the root mean square of
        the distances of the points the cubic is fitted to, shape (n_runs,) [m]. Run k begins at
        point k + 1.
    """
    count = len(points) - length - 1
    first = np.arange(1, count + 1)
    on_left = np.minimum(np.maximum(_BESIDE // 2, _BESIDE - (len(points) - first - length)), first)
    order = np.arange(_BESIDE)
    numbers = first[:, None] - on_left[:, None] + order
    numbers = numbers + np.where(order >= on_left[:, None], length, 0)
    near = points[numbers]
    along = np.concatenate(
        [np.zeros((count, 1)), np.cumsum(np.hypot(*np.diff(near, axis=1).transpose(2, 0, 1)), 1)],
        axis=1,
    )
    scale = np.maximum(along[:, -1:], _TINY)
    weights, rest = fit_cubics(along / scale, near)
    fit = np.sqrt((rest**2).sum(axis=(1, 2)) / (2 * (_BESIDE - 4)))
    begin = np.take_along_axis(along, on_left[:, None] - 1, axis=1) / scale
    end = np.take_along_axis(along, on_left[:, None], axis=1) / scale
    rows = np.arange(count)
    chord = near[rows, on_left] - near[rows, on_left - 1]
    run = points[first[:, None] + np.arange(length)]
    to_run = run - near[rows, on_left - 1][:, None, :]
    squared = np.maximum((chord**2).sum(axis=1), _TINY)
    share = (to_run * chord[:, None, :]).sum(axis=2) / squared[:, None]
    at = begin + np.clip(share, 0.0, 1.0) * (end - begin)
    terms = powers(at)
    reached = terms @ weights
    rate = (np.arange(1, 4) * terms[:, :, :3]) @ weights[:, 1:]
    apart = run - reached
    across = rate[..., 0] * apart[..., 1] - rate[..., 1] * apart[..., 0]
    return np.abs(across) / np.maximum(np.hypot(rate[..., 0], rate[..., 1]), 1e-12), fit
