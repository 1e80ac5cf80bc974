"""Followers that rock about a pivot: with a roller, an edge or a flat face.

The angle ψ is that between the arm and the line from the pivot to the axis of the cam; it grows
as the arm leaves the cam.
"""

from __future__ import annotations

import math
from typing import ClassVar, Literal

import numpy as np
from pydantic import Field

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.cams.analytic import arc_cosine, arc_sine, direction
from vehicledyn.cams.follower import (
    Array,
    CentreMotion,
    LineFollower,
    LineMotion,
    PointFollower,
)
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

_SIDES = {"above": 1.0, "below": -1.0}


class _Rocker(PointFollower):
    """A follower on an arm; its coordinate is the angle ψ."""

    pivot: float = quantity("m", "Distance of the pivot from the axis, along +X", gt=0.0)
    arm: float = quantity("m", "Length of the arm", gt=0.0)
    side: Literal["above", "below"] = Field(
        default="above", description="Side of the arm: +Y is above"
    )
    rocks: ClassVar[bool] = True

    def start(self, base_radius: float) -> float:
        """Return ψ on the base circle [rad]."""
        prime = base_radius + self.roller
        least, most = abs(self.pivot - self.arm), self.pivot + self.arm
        if not least < prime.real < most.real:
            word = "longer" if self.arm > self.pivot else "shorter"
            raise ValueError(
                f"the arm of {1e3 * self.arm:g} mm is {word} than its cam allows: with the pivot "
                f"at {1e3 * self.pivot:g} mm its end is between {1e3 * least:g} and "
                f"{1e3 * most:g} mm from the axis, the base circle asks for {1e3 * prime:g} mm; "
                f"take an arm between {1e3 * abs(self.pivot - prime):g} and "
                f"{1e3 * (self.pivot + prime):g} mm"
            )
        angle: float = arc_cosine(
            (self.pivot**2 + self.arm**2 - prime**2) / (2.0 * self.pivot * self.arm)
        )
        return angle

    def check_reach(self, coordinate: Array) -> None:
        """Refuse arms that turn beyond the line through pivot and axis."""
        if coordinate.max() >= math.pi or coordinate.min() <= 0.0:
            worst = coordinate.max() if coordinate.max() >= math.pi else coordinate.min()
            raise ValueError(
                f"the arm turns to {math.degrees(worst):.4g} deg from the line between pivot and "
                "axis, beyond 0 to 180 deg; the follower is longer than its cam allows: take less "
                "swing, another arm or another pivot"
            )

    def centre(self, coordinate: Array) -> CentreMotion:
        """Return the end of the arm."""
        s, c, side = np.sin(coordinate), np.cos(coordinate), _SIDES[self.side]
        l = self.arm  # noqa: E741
        return CentreMotion(
            np.array([self.pivot - l * c, side * l * s]),
            np.array([l * s, side * l * c]),
            np.array([l * c, -side * l * s]),
        )

    def pressure_sign(self) -> float:
        """Return the sign that counts the angle the way ψ grows."""
        return -_SIDES[self.side]

    def located(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
        """Return ψ and the angle of the cam."""
        l, d, side = self.arm, self.pivot, _SIDES[self.side]  # noqa: E741
        cosine = (d * d + l * l - x * x - y * y) / (2.0 * d * l)
        sine = ops.sqrt(1.0 - cosine * cosine)
        angle = ops.atan2(sine, cosine)
        return angle, ops.atan2(side * l * sine, d - l * cosine) - ops.atan2(y, x)


@register("cam_follower", "rocker_roller")
class RockingRoller(_Rocker):
    """A roller at the end of a rocking arm."""

    radius: float = quantity("m", "Radius of the roller", gt=0.0)

    @property
    def roller(self) -> float:
        """Radius of the roller [m]."""
        return self.radius


@register("cam_follower", "rocker_knife_edge")
class RockingEdge(_Rocker):
    """An edge at the end of a rocking arm."""


@register("cam_follower", "rocker_flat")
class RockingFace(LineFollower):
    """A flat face on a rocker; its coordinate is its angle ψ."""

    pivot: float = quantity("m", "Distance of the pivot from the axis, along +X", gt=0.0)
    offset: float = quantity(
        "m", "Distance of the face from the pivot, towards the cam", default=0.0
    )
    length: float | None = quantity(
        "m", "Length of the face, from the pivot's foot on it", default=None, gt=0.0
    )
    side: Literal["above", "below"] = Field(
        default="above", description="Side of the face: +Y is above"
    )
    rocks: ClassVar[bool] = True

    def start(self, base_radius: float) -> float:
        """Return ψ on the base circle [rad]."""
        reach = base_radius + self.offset
        if abs(reach) >= self.pivot.real:
            raise ValueError(
                f"the face does not reach the base circle: {1e3 * reach:g} mm of base radius and "
                f"offset pass the pivot at {1e3 * self.pivot:g} mm; move the pivot away"
            )
        angle: float = arc_sine(reach / self.pivot)
        return angle

    def check_reach(self, coordinate: Array) -> None:
        """Refuse faces that pass the direction square to the line from pivot to axis."""
        if np.abs(coordinate).max() >= 0.5 * math.pi:
            raise ValueError(
                "the face turns beyond 90 deg from the line between pivot and axis; the follower "
                "is longer than its cam allows: take less swing or another pivot"
            )

    def line(self, coordinate: Array) -> LineMotion:
        """Return the face."""
        side = _SIDES[self.side]
        s, c = np.sin(coordinate), np.cos(coordinate)
        angle = side * (0.5 * math.pi - coordinate)
        d = self.pivot
        return LineMotion(angle, -side, d * s - self.offset, d * c, -d * s)

    def pressure_angle(self, along: Array) -> Array:
        """Return the angle of the normal against the motion of the touching point [rad]."""
        return np.asarray(direction(self.offset, along))

    def located(self, angle: Scalar, distance: Scalar) -> tuple[Scalar, Scalar]:
        """Return ψ and the angle of the cam."""
        turned = ops.asin((distance + self.offset) / self.pivot)
        return turned, _SIDES[self.side] * (0.5 * math.pi - turned) - angle

    def along_face(self, coordinate: Array, contact: Array) -> Array:
        """Return the distance of the contact from the foot of the pivot [m]."""
        side = _SIDES[self.side]
        s, c = np.sin(coordinate), np.cos(coordinate)
        foot = np.array([self.pivot - self.offset * s, -self.offset * side * c])
        return np.asarray(np.sum(np.array([-c, side * s]) * (contact - foot), axis=0))
