"""Steps of measured profiles: places where the points on both sides do not continue each other.

A step lies where a cubic with a jump fits the points around a place at least four times as well as
a cubic alone, and the jump is more than 30 µm and twelve times the scatter of the points. Corners
and changes of curvature are none, as a jump does not help there. Two opposite steps bound a patch,
as dirt or a badly joined sweep leaves it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vehicledyn.rail.profiles.fitted_cubics import fit_cubics
from vehicledyn.rail.profiles.profile_pieces import Floats

_REACH, _FEWEST, _MOST = 2.5e-3, 5, 16
"""Length that is fitted on either side [m], and how many points that may be."""

_EDGE, _SKIPPED = 1e-3, (0, 1, 2, 4)
"""Longest rise of a step [m], and how many points on it are left out of the fit."""

_DEARER = 1.2
"""How much better a fit must be for each point left out [1]."""

_LEAST, _OF_SCATTER, _BETTER = 30e-6, 12.0, 4.0
_ROUNDING = 1e-6
_ALIKE = 2.0
_SHARE = 3
"""A patch has at most one point in three."""

_TINY = 1e-12


@dataclass(frozen=True)
class ProfileStep:
    """The numbers of the last point before it and the first behind it, and its height [m].

    The height is positive to the left of the way along the points.
    """

    before: int
    behind: int
    height: float


def find_steps(points: Floats, scatter: float) -> list[ProfileStep]:
    """Return the steps of points without gaps and outliers, in their order.

    Parameters
    ----------
    points
        y and z, shape (n, 2) [m].
    scatter
        Usual distance of a point from the curve through those around it [m].
    """
    if len(points) < 2 * _FEWEST:
        return []
    usual = max(float(np.median(np.hypot(*np.diff(points, axis=0).T))), _TINY)
    side = int(np.clip(round(_REACH / usual), _FEWEST, _MOST))
    least = max(_LEAST, _OF_SCATTER * scatter)
    found: list[tuple[float, ProfileStep]] = []
    for skipped in _SKIPPED:
        if (skipped and (skipped + 1) * usual > _EDGE) or len(points) < 2 * side + skipped:
            continue
        height, better = _jumps(points, side, skipped)
        for k in np.flatnonzero((np.abs(height) > least) & (better > _BETTER)):
            before = int(k) + side - 1
            step = ProfileStep(before, before + 1 + skipped, float(height[k]))
            found.append((float(better[k]) / _DEARER**skipped, step))
    chosen: list[ProfileStep] = []
    for _, step in sorted(found, key=lambda item: -item[0]):
        if all(abs(step.before - other.before) > side for other in chosen):
            chosen.append(step)
    return sorted(chosen, key=lambda step: step.before)


def find_patches(steps: list[ProfileStep], count: int) -> list[tuple[ProfileStep, ProfileStep]]:
    """Return pairs of opposite steps of like height that bound few of ``count`` points."""
    pairs, at = [], 0
    while at + 1 < len(steps):
        first, last = steps[at], steps[at + 1]
        low, high = sorted((abs(first.height), abs(last.height)))
        opposite = first.height * last.height < 0.0 and high < _ALIKE * low
        if opposite and last.before - first.before < count / _SHARE:
            pairs.append((first, last))
            at += 1
        at += 1
    return pairs


def _jumps(points: Floats, side: int, skipped: int) -> tuple[Floats, Floats]:
    """Return the jump at each place, and how many times better a cubic fits with it.

    Place k lies behind point k + side - 1; shape (n_places,) each.
    """
    windows = np.lib.stride_tricks.sliding_window_view(points, 2 * side + skipped, axis=0)
    used = np.r_[0:side, side + skipped : 2 * side + skipped]
    near = windows.transpose(0, 2, 1)[:, used]
    chord = near[:, -1] - near[:, 0]
    length = np.maximum(np.hypot(*chord.T), _TINY)
    forward = chord / length[:, None]
    apart = near - near[:, :1]
    x = (apart @ forward[:, :, None])[..., 0] / length[:, None]
    z = apart[..., 1] * forward[:, None, 0] - apart[..., 0] * forward[:, None, 1]
    jump = np.broadcast_to(np.where(np.arange(2 * side) < side, 0.0, 1.0), x.shape)
    left = fit_cubics(2.0 * x - 1.0, np.stack([z, jump], axis=-1))[1]
    rest, across = left[..., :1], left[..., 1:]
    height = (across * rest).sum(axis=1) / np.maximum((across**2).sum(axis=1), _TINY)
    without = np.sqrt((rest[..., 0] ** 2).mean(axis=1))
    with_jump = np.sqrt(((rest - height[:, None] * across)[..., 0] ** 2).mean(axis=1))
    return height[:, 0], without / np.maximum(with_jump, _ROUNDING)
