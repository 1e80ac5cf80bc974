"""The base of outlines: the shape of a cam is given, the motion of the follower follows."""

from __future__ import annotations

from abc import abstractmethod
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.parameters import ParameterSet
from vehicledyn.cams.follower import Follower, LineFollower, PointFollower
from vehicledyn.cams.geometry import FollowerMotion, turned
from vehicledyn.symbolic.ops import Scalar

Array = NDArray[np.float64]
_STEPS = 60
_FINE = 1e-15


class Support(NamedTuple):
    """Lines that touch an outline from outside, for angles φ of their normals, each (n,) [m].

    ``distance`` p from the axis, its derivative dp/dφ and the radius of curvature.
    """

    distance: Array
    aside: Array
    radius: Array


class Reach(NamedTuple):
    """Where a follower's centre rests on an outline: coordinates, normals (2, n), curvature.

    Normals are in axes of the cam, curvature is that of the pitch curve, positive where convex.
    """

    coordinate: Array
    normal: Array
    curvature: Array


class CamOutline(ParameterSet):
    """Base of the outlines of cams, closed curves about the origin in axes of the cam."""

    def beside(self, folder: Path) -> CamOutline:
        """Return the outline with what its files hold, relative to a folder."""
        return self

    @abstractmethod
    def support(self, angle: Array) -> Support:
        """Return the lines that touch the outline."""

    @abstractmethod
    def reach(self, follower: PointFollower, theta: Array) -> Reach:
        """Return where the centre of a roller or edge is that rests on the outline.

        Raises
        ------
        ValueError
            If it does not reach the outline.
        """

    @abstractmethod
    def point_gap(self, radius: float, x: Scalar, y: Scalar) -> Scalar:
        """Return how far a centre is outside the pitch curve of a roller, near it [m]."""

    @abstractmethod
    def line_gap(self, angle: Scalar, distance: Scalar) -> Scalar:
        """Return how far a face is outside the outline [m]."""

    def motion(self, follower: Follower, theta: Array) -> FollowerMotion:
        """Return the motion of a follower on the outline.

        Raises
        ------
        ValueError
            If the follower does not reach the outline, or runs along the axis.
        """
        if isinstance(follower, PointFollower):
            return self._of_point(follower, theta)
        if isinstance(follower, LineFollower):
            return self._of_line(follower, theta)
        raise ValueError(
            "an outline has followers that slide or rock in its plane; a face cam needs a motion"
        )

    def _of_point(self, follower: PointFollower, theta: Array) -> FollowerMotion:
        found = self.reach(follower, theta)
        centre = follower.centre(found.coordinate)
        # n · dP/dθ = 0 and n · d²P/dθ² + κ |dP/dθ|² = 0 along the pitch curve.
        normal = turned(theta, found.normal)
        spin = np.array([centre.place[1], -centre.place[0]])
        lever = np.sum(normal * centre.first, axis=0)
        slope = -np.sum(normal * spin, axis=0) / lever
        velocity = centre.first * slope
        along = velocity + spin
        rest = centre.second * slope**2 - centre.place
        rest = rest + 2.0 * np.array([velocity[1], -velocity[0]])
        bend = np.sum(normal * rest, axis=0) + found.curvature * np.sum(along**2, axis=0)
        return FollowerMotion(theta, found.coordinate, slope, -bend / lever)

    def _of_line(self, follower: LineFollower, theta: Array) -> FollowerMotion:
        distances = self.support(np.linspace(0.0, 2.0 * np.pi, 720)).distance
        coordinate = np.full(theta.shape, follower.start(distances[np.argmin(distances.real)]))
        is_settled = False
        for _ in range(_STEPS):
            line = follower.line(coordinate)
            touching = self.support(line.angle - theta)
            lever = line.first - touching.aside * line.turning
            step = (touching.distance - line.distance) / lever
            coordinate = coordinate + step
            # A step into the complex plane follows one step behind.
            if is_settled or (np.abs(step).max() < _FINE and not np.iscomplexobj(step)):
                break
            is_settled = bool(np.abs(step).max() < _FINE)
        line = follower.line(coordinate)
        touching = self.support(line.angle - theta)
        lever = line.first - touching.aside * line.turning
        slope = -touching.aside / lever
        turn = line.turning * slope - 1.0
        bend = (touching.radius - touching.distance) * turn**2 - line.second * slope**2
        return FollowerMotion(theta, coordinate, slope, bend / lever)
