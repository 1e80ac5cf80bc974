"""Followers that slide along a line: with a roller, an edge or a flat face."""

from __future__ import annotations

import math
from typing import ClassVar

import numpy as np

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.cams.analytic import cosine, sine, square_root
from vehicledyn.cams.follower import (
    Array,
    CentreMotion,
    LineFollower,
    LineMotion,
    PointFollower,
)
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


class _Sliding(PointFollower):
    """A follower whose centre slides along X = offset; its coordinate is the height of it."""

    offset: float = quantity("m", "Offset of the centre from the axis, along +X", default=0.0)

    def start(self, base_radius: float) -> float:
        """Return the height of the centre on the base circle [m]."""
        prime = base_radius + self.roller
        if abs(self.offset) >= prime.real:
            raise ValueError(
                f"the offset of {1e3 * self.offset:g} mm passes the base circle, whose radius with "
                f"the roller's is {1e3 * prime:g} mm; make it smaller"
            )
        height: float = square_root(prime**2 - self.offset**2)
        return height

    def check_reach(self, coordinate: Array) -> None:
        """Refuse centres below the axis."""
        if coordinate.min() <= 0.0:
            raise ValueError("the follower falls to the axis of the cam; take a larger base radius")

    def centre(self, coordinate: Array) -> CentreMotion:
        """Return the centre, which moves along +Y."""
        nothing, one = np.zeros_like(coordinate), np.ones_like(coordinate)
        place = np.array([nothing + self.offset, coordinate])
        return CentreMotion(place, np.array([nothing, one]), np.array([nothing, nothing]))

    def pressure_sign(self) -> float:
        """Return 1: positive where the normal leans towards -X."""
        return 1.0

    def located(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
        """Return the height and the angle of the cam."""
        height = ops.sqrt(x * x + y * y - self.offset**2)
        return height, ops.atan2(height, self.offset) - ops.atan2(y, x)


@register("cam_follower", "roller")
class SlidingRoller(_Sliding):
    """A roller that slides along a line, with or without offset."""

    radius: float = quantity("m", "Radius of the roller", gt=0.0)

    @property
    def roller(self) -> float:
        """Radius of the roller [m]."""
        return self.radius


@register("cam_follower", "knife_edge")
class SlidingEdge(_Sliding):
    """An edge that slides along a line, with or without offset."""


@register("cam_follower", "flat")
class SlidingFace(LineFollower):
    """A flat face that slides along a line through the axis; its coordinate is its height there."""

    tilt: float = quantity(
        "rad", "Angle of the face's normal against the travel", default=0.0, gt=-1.5, lt=1.5
    )
    face: tuple[float, float] | None = quantity(
        "m", "Where the face ends along -X and +X, from the axis of travel", default=None
    )
    rocks: ClassVar[bool] = False

    def start(self, base_radius: float) -> float:
        """Return the height of the face on the base circle [m]."""
        height: float = base_radius / cosine(self.tilt)
        return height

    def check_reach(self, coordinate: Array) -> None:
        """Refuse faces below the axis."""
        if coordinate.min() <= 0.0:
            raise ValueError("the follower falls to the axis of the cam; take a larger base radius")

    def line(self, coordinate: Array) -> LineMotion:
        """Return the face."""
        c, one = cosine(self.tilt), np.ones_like(coordinate)
        angle = (0.5 * math.pi + self.tilt) * one
        return LineMotion(angle, 0.0, c * coordinate, c * one, 0.0 * one)

    def pressure_angle(self, along: Array) -> Array:
        """Return the tilt [rad]."""
        return self.tilt * np.ones_like(along)

    def located(self, angle: Scalar, distance: Scalar) -> tuple[Scalar, Scalar]:
        """Return the height and the angle of the cam."""
        return distance / math.cos(self.tilt), 0.5 * math.pi + self.tilt - angle

    def along_face(self, coordinate: Array, contact: Array) -> Array:
        """Return the place from the axis of travel, towards +X [m]."""
        along = np.array([cosine(self.tilt), sine(self.tilt)])
        from_axis = contact - np.array([np.zeros_like(coordinate), coordinate])
        return np.asarray(along @ from_axis)
