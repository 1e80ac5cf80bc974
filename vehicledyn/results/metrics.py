"""Scalars drawn from channels: extreme values with their times, clearance of a body to cones.

An extreme of samples that hold NaN is NaN, at the time of the first of them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from vehicledyn.base.errors import InputError

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Extreme:
    """A value of a channel and the time [s] at which it occurs."""

    value: float
    time: float


def largest(time: ArrayLike, values: ArrayLike) -> Extreme:
    """Return the largest value and the first time it occurs."""
    return _pick(time, values, np.asarray(values, dtype=float))


def smallest(time: ArrayLike, values: ArrayLike) -> Extreme:
    """Return the smallest value and the first time it occurs."""
    return _pick(time, values, -np.asarray(values, dtype=float))


def peak(time: ArrayLike, values: ArrayLike) -> Extreme:
    """Return the value of largest magnitude, with its sign, and the first time it occurs."""
    return _pick(time, values, np.abs(np.asarray(values, dtype=float)))


class RunningExtreme:
    """An extreme value of samples that come block by block.

    Parameters
    ----------
    pick
        :func:`largest`, :func:`smallest` or :func:`peak`.
    """

    def __init__(self, pick: Callable[[ArrayLike, ArrayLike], Extreme]) -> None:
        self._pick = pick
        self.found: Extreme | None = None

    def take(self, time: ArrayLike, values: ArrayLike) -> None:
        """Take further samples, if there are any."""
        if not np.size(values):
            return
        here = self._pick(time, values)
        if self.found is not None:
            known = self.found
            here = self._pick([known.time, here.time], [known.value, here.value])
        self.found = here

    @property
    def value(self) -> float:
        """The value; NaN if there were no samples."""
        return np.nan if self.found is None else self.found.value


@dataclass(frozen=True)
class Clearance:
    """Smallest distance of a moving body to each of several cones.

    ``distance`` is negative where the body overlaps a cone, shape (n_cones,) [m];
    ``sample`` is the index of the pose at which it occurs, shape (n_cones,).
    """

    distance: Floats
    sample: NDArray[np.int64]


def clearance(
    outline: ArrayLike,
    x: ArrayLike,
    y: ArrayLike,
    heading: ArrayLike,
    *,
    cones: ArrayLike,
    radius: float = 0.0,
) -> Clearance:
    """Return how close a body's outline comes to cones over a series of poses.

    d = min over poses of the signed distance of the cone's axis to the polygon, less the
    radius. The distance to the polygon is exact, negative inside. Between the poses nothing
    is tested, so they must lie closer than the clearance should be accurate. Poses that are
    not finite are passed over; without any other the distances are NaN.

    Parameters
    ----------
    outline
        Corners of the body in its own axes, in order round it, shape (n_corners, 2) [m].
    x, y
        Position of the body's origin, shape (n,) [m].
    heading
        Angle from the ground's x axis to the body's, shape (n,) [rad].
    cones
        Positions of the cones, shape (n_cones, 2) [m].
    radius
        Radius of a cone [m].

    Raises
    ------
    InputError
        If the outline has fewer than three corners or there is no pose.
    """
    corners = np.asarray(outline, dtype=float)
    position = np.stack([np.asarray(x, dtype=float), np.asarray(y, dtype=float)], axis=1)
    angle = np.asarray(heading, dtype=float)
    points = np.asarray(cones, dtype=float).reshape(-1, 2)
    if corners.ndim != 2 or corners.shape[0] < 3 or corners.shape[1] != 2:
        raise InputError(f"an outline needs at least three corners, found {corners.shape}")
    if not len(position):
        raise InputError("clearance needs at least one pose")
    distance = np.full(len(points), np.nan)
    sample = np.zeros(len(points), dtype=np.int64)
    known = np.flatnonzero(np.isfinite(position).all(axis=1) & np.isfinite(angle))
    if not len(known):
        return Clearance(distance, sample)
    for index, cone in enumerate(points):
        near = known[_near_poses(corners, position[known] - cone)]
        local = _in_body_axes(cone - position[near], angle[near])
        signed = distance_to_polygon(local, corners)
        closest = int(np.argmin(signed))
        distance[index] = signed[closest] - radius
        sample[index] = near[closest]
    return Clearance(distance, sample)


def distance_to_polygon(points: ArrayLike, corners: ArrayLike) -> Floats:
    """Return the signed distance of points to a simple polygon, negative inside.

    Parameters
    ----------
    points
        Shape (n, 2) [m].
    corners
        Corners in order, either way round, shape (n_corners, 2) [m].

    Returns
    -------
    Floats
        Distances, shape (n,) [m].
    """
    where = np.asarray(points, dtype=float)
    starts = np.asarray(corners, dtype=float)
    squared = np.full(len(where), np.inf)
    inside = np.zeros(len(where), dtype=bool)
    for start, end in zip(starts, np.roll(starts, -1, axis=0), strict=True):
        edge = end - start
        offset = where - start
        length = float(edge @ edge)
        along = np.clip(offset @ edge / length, 0.0, 1.0) if length > 0.0 else np.zeros(len(where))
        gap = offset - along[:, None] * edge
        squared = np.minimum(squared, np.einsum("ij,ij->i", gap, gap))
        # A ray towards +x crosses the edge: the count of crossings is odd inside.
        spans = (start[1] > where[:, 1]) != (end[1] > where[:, 1])
        turn = edge[0] * offset[:, 1] - edge[1] * offset[:, 0]
        inside ^= spans & ((turn > 0.0) == (edge[1] > 0.0))
    distance: Floats = np.sqrt(squared)
    distance[inside] *= -1.0
    return distance


def _pick(time: ArrayLike, values: ArrayLike, rank: Floats) -> Extreme:
    if not rank.size:
        raise InputError("an extreme value needs at least one sample")
    index = int(np.argmax(rank))
    return Extreme(float(np.asarray(values)[index]), float(np.asarray(time)[index]))


def _near_poses(corners: Floats, offset: Floats) -> NDArray[np.int64]:
    """Return the poses that can hold the smallest distance.

    The signed distance differs from the distance of the origin by at most the reach R of
    the corners, so a pose farther than the nearest by more than 2 R cannot win.
    """
    reach = float(np.max(np.hypot(corners[:, 0], corners[:, 1])))
    away = np.hypot(offset[:, 0], offset[:, 1])
    return np.flatnonzero(away <= np.min(away) + 2.0 * reach)


def _in_body_axes(offset: Floats, heading: Floats) -> Floats:
    cosine, sine = np.cos(heading), np.sin(heading)
    return np.stack(
        [
            cosine * offset[:, 0] + sine * offset[:, 1],
            cosine * offset[:, 1] - sine * offset[:, 0],
        ],
        axis=1,
    )
