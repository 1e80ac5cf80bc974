"""The gap between a cam and its follower, as an expression of where the follower is.

A motion law gives the gap without search: the place of a follower in axes of the cam determines
the coordinate c that it has and the angle θ of the cam at which the cam leads it there, and the
gap is c - c₀ - s(θ), divided by its slope across the profile. So it is exact where it is zero, for
any guidance of the follower, and to first order beside.
"""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.cams.cam import Cam
from vehicledyn.cams.follower import LineFollower, PointFollower
from vehicledyn.cams.followers.axial import AxialRoller
from vehicledyn.cams.turns import wrapped
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


@dataclass(frozen=True)
class Gap:
    """Distance of a follower from a cam, in axes of the cam.

    ``distance`` is positive when apart [m], ``normal`` the unit vector away from the cam, in the
    plane of the cam, or of a face cam around it and along its axis. ``along`` is the place of the
    contact on a flat face, from the point that is given of it, square to the normal [m].
    """

    distance: Scalar
    normal: tuple[Scalar, Scalar]
    along: Scalar = 0.0


def point_gap(cam: Cam, x: Scalar, y: Scalar) -> Gap:
    """Return the gap of a roller or edge whose centre is at a place in axes of the cam [m]."""
    follower = cam.touch
    if not isinstance(follower, PointFollower):
        raise TypeError("only rollers and edges have a centre")
    px, py = ops.symbol("x"), ops.symbol("y")
    if cam.curve is None:
        raw = cam.shape.point_gap(follower.roller, px, py)
    else:
        coordinate, theta = follower.located(px, py)
        raw = coordinate - cam.start - cam.curve.value(wrapped(theta))
    return _scaled(raw, (px, py), (x, y))


def line_gap(cam: Cam, x: Scalar, y: Scalar, nx: Scalar, ny: Scalar) -> Gap:
    """Return the gap of a flat face through a point, with a unit normal away from the cam.

    Parameters
    ----------
    cam
        The cam.
    x, y
        A point of the face in axes of the cam [m].
    nx, ny
        Normal of the face [1].
    """
    follower = cam.touch
    if not isinstance(follower, LineFollower):
        raise TypeError("only flat followers have a face")
    angle, distance = ops.symbol("angle"), ops.symbol("distance")
    if cam.curve is None:
        raw = cam.shape.line_gap(angle, distance)
    else:
        coordinate, theta = follower.located(angle, distance)
        raw = coordinate - cam.start - cam.curve.value(wrapped(theta))
    by_distance = ops.derivative(raw, distance, 1.0)
    by_angle = ops.derivative(raw, angle, 1.0)
    column = ops.column([raw / by_distance, -by_angle / by_distance])
    given = ops.column([ops.atan2(ny, nx), nx * x + ny * y])
    found = ops.substitute(column, ops.column([angle, distance]), given)
    # The contact is at p n + dp/dφ t; the point of the face has its own place along t = z × n.
    along = found[1] - (nx * y - ny * x)
    return Gap(found[0], (nx, ny), along)


def axial_gap(cam: Cam, angle: Scalar, height: Scalar) -> Gap:
    """Return the gap of the roller of a face cam.

    Parameters
    ----------
    cam
        The cam.
    angle
        Angle of the roller's middle in axes of the cam, from where it is at the start [rad].
    height
        Height of the roller's middle along the axis [m].
    """
    follower = cam.touch
    if not isinstance(follower, AxialRoller) or cam.curve is None:
        raise TypeError("only face cams have axial followers")
    around, up = ops.symbol("around"), ops.symbol("up")
    raw = up - cam.start - cam.curve.value(wrapped(-around / follower.distance))
    return _scaled(raw, (around, up), (follower.distance * angle, height))


def _scaled(raw: Scalar, symbols: tuple[Scalar, Scalar], values: tuple[Scalar, Scalar]) -> Gap:
    """Return a function that vanishes on a curve over the length of its gradient."""
    slopes = [ops.derivative(raw, symbol, 1.0) for symbol in symbols]
    size = ops.sqrt(slopes[0] * slopes[0] + slopes[1] * slopes[1])
    column = ops.column([raw / size, slopes[0] / size, slopes[1] / size])
    found = ops.substitute(column, ops.column(list(symbols)), ops.column(list(values)))
    return Gap(found[0], (found[1], found[2]))
