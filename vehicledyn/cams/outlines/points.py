"""Outlines from measured points."""

from __future__ import annotations

import math
import warnings
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, PrivateAttr

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.cams.analytic import direction, is_stepped, length, real_part
from vehicledyn.cams.follower import PointFollower
from vehicledyn.cams.geometry import turned
from vehicledyn.cams.outline import Array, CamOutline, Reach, Support
from vehicledyn.cams.pieces import hermite_table
from vehicledyn.cams.point_tables import read_point_table
from vehicledyn.cams.turns import wrapped
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.tables import CurveTable

_TURN = 2.0 * math.pi
_SAMPLES = 2048
_STEPS = 60
_LEAST = 12
_ASIDE = 1e-40
Numbers = NDArray[Any]


class _Curve(NamedTuple):
    """Points of the outline with derivatives by the polar angle, shape (2, n)."""

    place: Numbers
    first: Numbers
    second: Numbers

    @property
    def normal(self) -> Array:
        """Outward normals."""
        return np.asarray(np.array([self.first[1], -self.first[0]]) / length(*self.first))

    @property
    def curvature(self) -> Array:
        """Curvature, positive where convex [1/m]."""
        turn = self.first[0] * self.second[1] - self.first[1] * self.second[0]
        return np.asarray(turn / length(*self.first) ** 3)


@register("cam_outline", "points")
class MeasuredPoints(CamOutline):
    """A smooth closed curve through measured points, given by their polar angles and radii.

    The points are in a CSV file with two columns, ``angle [deg]`` and ``radius [mm]``. The radius
    becomes a periodic quintic spline of the angle, which may pass measured points by a tolerance.
    """

    file: str = Field(description="The points, relative to the file that names it")
    tolerance: float = quantity("m", "Standard deviation of the points", default=0.0, ge=0.0)
    _spline: Any = PrivateAttr(default=None)

    def beside(self, folder: Path) -> MeasuredPoints:
        """Return the outline with its points read.

        Raises
        ------
        InputError
            If the file cannot be read.
        """
        from scipy.interpolate import splrep

        angles, radii, _ = read_point_table(folder / self.file, ("rad",), ("m",))
        if abs(angles[-1] - angles[0] - _TURN) > 1e-9:
            angles, radii = np.append(angles, angles[0] + _TURN), np.append(radii, radii[0])
        if len(angles) < _LEAST or not (np.diff(angles) > 0.0).all():
            raise ValueError(
                f"{self.file}: give at least {_LEAST} points with angles that grow by less than a "
                "turn in all"
            )
        if radii.min() <= 0.0:
            raise ValueError(f"{self.file}: radii must be above zero; the axis is inside the cam")
        radii[-1] = radii[0]
        found = self.model_copy()
        smooth = len(angles) * self.tolerance**2
        with warnings.catch_warnings():
            warnings.simplefilter("error", RuntimeWarning)
            try:
                found._spline = splrep(angles, radii, k=5, s=smooth, per=1)
            except RuntimeWarning:
                raise ValueError(
                    f"{self.file}: no smooth curve passes the points within "
                    f"{1e6 * self.tolerance:g} um; give another tolerance, or 0 for a curve "
                    "through all of them"
                ) from None
        return found

    def support(self, angle: Array) -> Support:
        """Return the touching lines, by Newton steps from the furthest of many points."""
        c, s = np.cos(angle.real), np.sin(angle.real)
        psi = self._grid[_furthest(self._curve(self._grid).place, angle.real)]
        for _ in range(_STEPS):
            curve = self._curve(psi)
            slope = c * curve.first[0] + s * curve.first[1]
            bend = c * curve.second[0] + s * curve.second[1]
            step = np.where(bend < 0.0, -slope / np.where(bend < 0.0, bend, -1.0), 0.0)
            psi = psi + np.clip(step, -_TURN / _SAMPLES, _TURN / _SAMPLES)
            if np.abs(step).max() < 1e-15:
                break
        if np.iscomplexobj(angle):
            c, s = np.cos(angle), np.sin(angle)
            slope = c * curve.first[0] + s * curve.first[1]
            psi = psi - slope / (c * curve.second[0] + s * curve.second[1])
        curve = self._curve(psi)
        p = c * curve.place[0] + s * curve.place[1]
        return Support(p, c * curve.place[1] - s * curve.place[0], 1.0 / curve.curvature)

    def reach(self, follower: PointFollower, theta: Array) -> Reach:
        """Return the outermost place of the moved-out outline on the path of the centre."""
        psi = self._met(real_part(follower), theta)
        if is_stepped(follower):
            aside = self._miss(real_part(follower), theta, psi + 1j * _ASIDE).imag / _ASIDE
            psi = psi - self._miss(follower, theta, psi) / aside
        curve = self._curve(psi)
        curvature = 1.0 / (1.0 / curve.curvature + follower.roller)
        return Reach(self._height(follower, theta, psi), curve.normal, curvature)

    def _met(self, follower: PointFollower, theta: Array) -> Array:
        """Return the polar angles of that place."""
        grid = np.append(self._grid, _TURN)
        miss = self._miss(follower, theta, grid[:, None])
        crosses = np.sign(miss[:-1]) != np.sign(miss[1:])
        heights = self._height(follower, theta, self._grid[:, None])
        best = np.argmax(np.where(crosses, heights, -np.inf), axis=0)
        if not crosses.any(axis=0).all():
            raise ValueError(
                "the follower does not reach the outline; it is shorter or longer than its cam "
                "allows: change its arm, offset or pivot"
            )
        low, high = grid[best], grid[best + 1]
        sign = np.sign(miss[best, np.arange(theta.size)])
        for _ in range(_STEPS):
            middle = 0.5 * (low + high)
            left = np.sign(self._miss(follower, theta, middle)) == sign
            low, high = np.where(left, middle, low), np.where(left, high, middle)
        return np.asarray(0.5 * (low + high))

    def point_gap(self, radius: float, x: Scalar, y: Scalar) -> Scalar:
        """Return how far the centre is outside the moved-out outline along its radius [m]."""
        table = self._moved_out(radius)
        return ops.sqrt(x * x + y * y) - table.value(wrapped(ops.atan2(y, x)))

    def line_gap(self, angle: Scalar, distance: Scalar) -> Scalar:
        """Return how far the face is from touching [m]."""
        return distance - self._supports.value(wrapped(angle))

    @cached_property
    def _grid(self) -> Array:
        return np.linspace(0.0, _TURN, _SAMPLES, endpoint=False)

    @cached_property
    def _supports(self) -> CurveTable:
        angles = np.linspace(0.0, _TURN, _SAMPLES + 1)
        p, aside, radius = self.support(angles)
        return hermite_table("cam support", angles, np.array([p, aside, radius - p]))

    def _moved_out(self, radius: float) -> CurveTable:
        """Return the polar radius of the outline moved out, by the polar angle."""
        angles = np.linspace(0.0, _TURN, _SAMPLES + 1)
        psi = angles.copy()
        for _ in range(_STEPS):
            curve = self._curve(psi)
            place = curve.place + radius * curve.normal
            miss = np.mod(np.arctan2(place[1], place[0]) - angles + math.pi, _TURN) - math.pi
            psi = psi - miss
            if np.abs(miss).max() < 1e-15:
                break
        curve = self._curve(psi)
        normal = curve.normal
        place = curve.place + radius * normal
        r = np.hypot(*place)
        c, s = np.cos(angles), np.sin(angles)
        outward, around = c * normal[0] + s * normal[1], c * normal[1] - s * normal[0]
        slope = -r * around / outward
        kappa = 1.0 / (1.0 / curve.curvature + radius)
        second = (r**2 + 2.0 * slope**2 - kappa * (r**2 + slope**2) ** 1.5) / r
        return hermite_table("cam pitch curve", angles, np.array([r, slope, second]))

    def _curve(self, psi: Numbers) -> _Curve:
        from scipy.interpolate import splev

        if self._spline is None:
            raise ValueError(f"{self.file}: has not been read")
        begin, at = float(self._spline[0][5]), np.real(psi)
        x = begin + np.mod(at - begin, _TURN)
        r, r1, r2 = (np.asarray(splev(x, self._spline, der=k)) for k in range(3))
        c, s = np.cos(at), np.sin(at)
        found = _Curve(
            np.array([r * c, r * s]),
            np.array([r1 * c - r * s, r1 * s + r * c]),
            np.array([r2 * c - 2.0 * r1 * s - r * c, r2 * s + 2.0 * r1 * c - r * s]),
        )
        if not np.iscomplexobj(psi):
            return found
        along, across = np.asarray(splev(x, self._spline, der=3)) - 3.0 * r1, 3.0 * r2 - r
        third = np.array([along * c - across * s, along * s + across * c])
        step = 1j * np.imag(psi)
        return _Curve(
            found.place + found.first * step,
            found.first + found.second * step,
            found.second + third * step,
        )

    def _centre(self, follower: PointFollower, theta: Array, psi: Numbers) -> Array:
        curve = self._curve(psi)
        return turned(theta, curve.place + follower.roller * curve.normal)

    def _miss(self, follower: PointFollower, theta: Array, psi: Numbers) -> Array:
        """Return how far a centre on the moved-out outline is beside its path [m]."""
        x, y = self._centre(follower, theta, psi)
        if not follower.rocks:
            return np.asarray(x - follower.centre(np.ones(1)).place[0, 0])
        return np.asarray(length(x - follower.pivot, y) - follower.arm)  # type: ignore[attr-defined]

    def _height(self, follower: PointFollower, theta: Array, psi: Array) -> Array:
        """Return the coordinate of a follower whose centre is there."""
        x, y = self._centre(follower, theta, psi)
        if not follower.rocks:
            return np.asarray(y)
        side = -follower.pressure_sign()
        return np.asarray(direction(side * y, follower.pivot - x))  # type: ignore[attr-defined]


def _furthest(places: Array, angle: Array) -> NDArray[np.intp]:
    """Return the numbers of the places, shape (2, n), that lie furthest in directions [rad].

    A corner of the convex hull does so between the normals of the edges that meet there.
    """
    from scipy.spatial import ConvexHull

    corners = ConvexHull(places.T).vertices  # counterclockwise
    edge = np.roll(places[:, corners], -1, axis=1) - places[:, corners]
    normals = np.arctan2(-edge[0], edge[1])
    order = np.argsort(normals)
    wrapped = np.arctan2(np.sin(angle), np.cos(angle))
    before = order[np.searchsorted(normals[order], wrapped) - 1]
    return np.asarray(corners[(before + 1) % len(corners)])
