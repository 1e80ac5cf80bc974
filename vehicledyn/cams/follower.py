"""The base of followers: what touches a cam, and how its one coordinate moves it.

Ground axes: the cam turns by +θ about the origin, a point p of the cam lies at Rz(θ) p. A sliding
follower moves along +Y; a rocking one turns about a pivot on the +X axis.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import ClassVar, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.parameters import ParameterSet
from vehicledyn.symbolic.ops import Scalar

Array = NDArray[np.float64]


class CentreMotion(NamedTuple):
    """Place of a follower's centre and its first two derivatives by the coordinate, (2, n)."""

    place: Array
    first: Array
    second: Array


class LineMotion(NamedTuple):
    """The face of a flat follower as a function of the coordinate, each of shape (n,).

    ``angle`` is that of its normal away from the cam [rad], ``distance`` that of the face from
    the axis of the cam [m]; derivatives by the coordinate follow.
    """

    angle: Array
    turning: float
    distance: Array
    first: Array
    second: Array


class Follower(ParameterSet):
    """Base of the followers."""

    rocks: ClassVar[bool] = False
    shape: ClassVar[Literal["point", "line", "axial"]] = "point"

    @property
    def roller(self) -> float:
        """Radius of what touches the cam; zero of an edge [m]."""
        return 0.0

    @abstractmethod
    def start(self, base_radius: float) -> float:
        """Return the coordinate on the base circle: a height [m] or angle [rad].

        Raises
        ------
        ValueError
            If the follower does not reach the base circle.
        """

    @abstractmethod
    def check_reach(self, coordinate: Array) -> None:
        """Refuse coordinates that the follower cannot have.

        Raises
        ------
        ValueError
            If there is one.
        """


class PointFollower(Follower):
    """Base of the followers that touch with a roller or an edge."""

    @abstractmethod
    def centre(self, coordinate: Array) -> CentreMotion:
        """Return where the centre of the roller is, in ground axes [m]."""

    @abstractmethod
    def pressure_sign(self) -> float:
        """Return the sign of the angle from its motion to the normal."""

    @abstractmethod
    def located(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
        """Return coordinate and angle of the cam for a centre in axes of the cam."""


class LineFollower(Follower):
    """Base of the followers that touch with a flat face."""

    shape: ClassVar[Literal["point", "line", "axial"]] = "line"

    @abstractmethod
    def line(self, coordinate: Array) -> LineMotion:
        """Return the face."""

    @abstractmethod
    def pressure_angle(self, along: Array) -> Array:
        """Return the angle between the normal and the motion of the touching point [rad].

        ``along`` are the places of the contact along the face [m].
        """

    @abstractmethod
    def located(self, angle: Scalar, distance: Scalar) -> tuple[Scalar, Scalar]:
        """Return coordinate and angle of the cam for a face in axes of the cam."""

    @abstractmethod
    def along_face(self, coordinate: Array, contact: Array) -> Array:
        """Return the place of a contact along the face, from its foot [m]."""
