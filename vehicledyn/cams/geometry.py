"""Geometry of cams and followers in numbers: pitch curve, profile, pressure angle, curvature.

For a follower with a centre C(c) and the coordinate c(θ) the pitch curve in axes of the cam is
P = Rz(-θ) C. For a flat face with the normal at the angle a(c), at the distance p(c) from the
axis, the cam is the envelope of the faces: with φ = a - θ and p' = dp/dφ it touches at p n + p' t,
and its radius of curvature is p + p''. Derivatives of c follow from a motion law, or from the
shape of an outline.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.cams.analytic import direction, length
from vehicledyn.cams.follower import Follower, LineFollower, PointFollower
from vehicledyn.cams.followers.axial import AxialRoller

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FollowerMotion:
    """Angles of the cam [rad] and the follower's coordinate c with its derivatives by them."""

    theta: Array
    coordinate: Array
    slope: Array
    second: Array


@dataclass(frozen=True)
class CamGeometry:
    """A cam at some angles, arrays of shape (n,) or (2, n); lengths in m, angles in rad.

    ``pitch`` is the path of the roller's centre in axes of the cam, ``profile`` the cam itself;
    ``pitch_radius`` and ``profile_radius`` are radii of curvature, positive where convex, infinite
    where straight. ``lever`` times the normal force is the force on the coordinate. ``along`` is
    the place of the contact on a flat face. Of a face cam the axes are those of the developed
    cylinder.
    """

    motion: FollowerMotion
    pitch: Array
    profile: Array
    pressure_angle: Array
    pitch_radius: Array
    profile_radius: Array
    lever: Array
    along: Array | None
    normal: Array


def geometry_of(follower: Follower, motion: FollowerMotion) -> CamGeometry:
    """Return the geometry of a follower that moves as given."""
    if isinstance(follower, PointFollower):
        return _of_point(follower, motion)
    if isinstance(follower, LineFollower):
        return _of_line(follower, motion)
    if not isinstance(follower, AxialRoller):
        raise TypeError(f"a follower of unknown shape: {type(follower).__name__}")
    return _of_axial(follower, motion)


def turned(angle: Array, points: Array) -> Array:
    """Return Rz(angle) points, shape (2, n)."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * points[0] - s * points[1], s * points[0] + c * points[1]])


def crossed(a: Array, b: Array) -> Array:
    """Return the z component of a × b, shape (n,)."""
    return np.asarray(a[0] * b[1] - a[1] * b[0])


def _left(a: Array) -> Array:
    """Return z × a."""
    return np.array([-a[1], a[0]])


def _of_point(follower: PointFollower, motion: FollowerMotion) -> CamGeometry:
    centre = follower.centre(motion.coordinate)
    velocity = centre.first * motion.slope
    bend = centre.second * motion.slope**2 + centre.first * motion.second
    along = velocity - _left(centre.place)
    curving = bend - 2.0 * _left(velocity) - centre.place
    size = length(*along)
    normal = _left(along) / size
    with np.errstate(divide="ignore"):
        radius = -(size**3) / crossed(along, curving)
    towards = centre.first / length(*centre.first)
    sign = follower.pressure_sign()
    pressure = sign * direction(crossed(towards, normal), np.sum(towards * normal, axis=0))
    pitch = turned(-motion.theta, centre.place)
    profile = pitch - follower.roller * turned(-motion.theta, normal)
    return CamGeometry(
        motion,
        pitch,
        profile,
        pressure,
        radius,
        radius - follower.roller,
        np.sum(normal * centre.first, axis=0),
        None,
        normal,
    )


def _of_line(follower: LineFollower, motion: FollowerMotion) -> CamGeometry:
    line = follower.line(motion.coordinate)
    turn = line.turning * motion.slope - 1.0
    first = line.first * motion.slope
    second = line.second * motion.slope**2 + line.first * motion.second
    aside = first / turn
    with np.errstate(divide="ignore", invalid="ignore"):
        bend = (second / turn - first * line.turning * motion.second / turn**2) / turn
    radius = line.distance + bend
    normal = np.array([np.cos(line.angle), np.sin(line.angle)])
    contact = line.distance * normal + aside * _left(normal)
    along = follower.along_face(motion.coordinate, contact)
    profile = turned(-motion.theta, contact)
    return CamGeometry(
        motion,
        profile,
        profile,
        follower.pressure_angle(along),
        radius,
        radius,
        line.first - line.turning * aside,
        along,
        normal,
    )


def _of_axial(follower: AxialRoller, motion: FollowerMotion) -> CamGeometry:
    around = follower.distance * np.ones_like(motion.theta)
    size = length(around, motion.slope)
    normal = np.array([-motion.slope, around]) / size
    with np.errstate(divide="ignore"):
        radius = -(size**3) / (around * motion.second)
    pitch = np.array([follower.distance * motion.theta, motion.coordinate])
    return CamGeometry(
        motion,
        pitch,
        pitch - follower.roller * normal,
        direction(motion.slope, around),
        radius,
        radius - follower.roller,
        normal[1],
        None,
        normal,
    )
