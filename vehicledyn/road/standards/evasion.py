"""Lanes between cones of ISO 3888-1 and -2, and how a car passes them with its swept corners."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vehicledyn.road.standards.signals import Floats


@dataclass(frozen=True)
class Lane:
    """A section between two rows of cones: where along x, and its right and left edge [m]."""

    begin: float
    end: float
    right: float
    left: float

    @property
    def width(self) -> float:
        """Clear width [m]."""
        return self.left - self.right

    @property
    def middle(self) -> float:
        """Lateral position of its centre line [m]."""
        return 0.5 * (self.left + self.right)


@dataclass(frozen=True)
class Passed:
    """How a lane was passed: smallest distance of a corner to its edges, and where [m]."""

    clearance: float
    x: float
    entered: bool


def double_lane_change(width: float, begin: float) -> tuple[Lane, Lane, Lane]:
    """Return the three lanes of the double lane change of ISO 3888-1.

    Sections are 15, 30, 25, 25, 15 m long, of which the first, third and fifth have edges 1.1, 1.2
    and 1.3 times the vehicle's width and 0.25 m apart. The third is 3.5 m to the left, right edge
    from right edge; public sources disagree about which edges that distance joins.

    Parameters
    ----------
    width
        Width of the vehicle without mirrors [m].
    begin
        Where the first section begins [m].
    """
    first, third, fifth = (factor * width + 0.25 for factor in (1.1, 1.2, 1.3))
    right = -0.5 * first
    side = right + 3.5
    return (
        Lane(begin, begin + 15.0, right, right + first),
        Lane(begin + 45.0, begin + 70.0, side, side + third),
        Lane(begin + 95.0, begin + 110.0, right, right + fifth),
    )


def obstacle_avoidance(width: float, begin: float) -> tuple[Lane, Lane, Lane]:
    """Return the three lanes of the obstacle avoidance of ISO 3888-2.

    Sections are 12, 13.5, 11, 12.5 and 12 m long; the first is 1.1 times the width and 0.25 m wide,
    the third the width and 1 m, the fifth 3 m (or 1.3 times the width and 0.25 m, if that is more).
    The right edge of the third is 1 m to the left of the first one's left edge.
    """
    first, third, fifth = 1.1 * width + 0.25, width + 1.0, max(3.0, 1.3 * width + 0.25)
    right = -0.5 * first
    left = right + first
    return (
        Lane(begin, begin + 12.0, right, left),
        Lane(begin + 25.5, begin + 36.5, left + 1.0, left + 1.0 + third),
        Lane(begin + 49.0, begin + 61.0, left - fifth, left),
    )


def cones(lanes: tuple[Lane, ...]) -> list[tuple[float, float]]:
    """Return the cones at the edges of all lanes, begin, middle and end, shape (n, 2) [m]."""
    return [
        (x, y)
        for lane in lanes
        for x in (lane.begin, 0.5 * (lane.begin + lane.end), lane.end)
        for y in (lane.right, lane.left)
    ]


def passage(lane: Lane, outline: tuple[tuple[float, float], ...], pose: Floats) -> Passed:
    """Return how the corners of a body pass a lane.

    Parameters
    ----------
    lane
        The lane.
    outline
        Corners in axes of the body, shape (m, 2) [m].
    pose
        x, y and yaw of the body, shape (3, n_times) [m, m, rad].

    Returns
    -------
    Passed
        ``clearance`` is negative where a corner was outside while inside the section's length.
    """
    import numpy as np

    x, y, yaw = pose
    ahead, aside = (np.array([corner[k] for corner in outline])[:, None] for k in (0, 1))
    corner_x = x + np.cos(yaw) * ahead - np.sin(yaw) * aside
    corner_y = y + np.sin(yaw) * ahead + np.cos(yaw) * aside
    inside = (corner_x >= lane.begin) & (corner_x <= lane.end)
    if not inside.any() or not (corner_x > lane.end).all(axis=0).any():
        return Passed(float("nan"), float("nan"), entered=False)
    free = np.where(inside, np.minimum(lane.left - corner_y, corner_y - lane.right), np.inf)
    at = np.unravel_index(int(np.argmin(free)), free.shape)
    return Passed(float(free[at]), float(corner_x[at]), entered=True)
