"""A cam: its motion or outline, and its follower; geometry in numbers, gap in expressions."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, model_validator

from vehicledyn.base.parameters import ParameterSet, part, quantity
from vehicledyn.cams.conjugate import Conjugate
from vehicledyn.cams.follower import Follower
from vehicledyn.cams.geometry import CamGeometry, FollowerMotion, geometry_of
from vehicledyn.cams.motion import TURN, motion_of
from vehicledyn.cams.motion_law import MotionLaw
from vehicledyn.cams.outline import CamOutline
from vehicledyn.cams.pieces import PieceCurve

Array = NDArray[np.float64]
_BESIDE, _LEVEL = 1e-7, 1e-5
"""Angle beside a least value [rad], and the change of slope there, over it, of a corner [1]."""

_ZOOMS = 6
"""Times that a least value is sought, each 16 times as finely: to 1e-8 rad."""


class Cam(ParameterSet):
    """A cam by the motion of its follower, or by its outline."""

    in_equations = True

    follower: ParameterSet = part("cam_follower", "What touches the cam")
    motion: list[ParameterSet] | None = part(
        "motion_law", "Motion laws one after the other, over a turn", default=None
    )
    base_radius: float | None = quantity(
        "m", "Radius of the base circle, where there is no lift", default=None, gt=0.0
    )
    outline: ParameterSet | None = part("cam_outline", "Shape of the cam", default=None)
    conjugate: Conjugate | None = Field(
        default=None, description="Second cam, which moves the follower back"
    )

    @model_validator(mode="after")
    def _one_way(self) -> Any:
        if (self.motion is None) == (self.outline is None):
            raise ValueError("give either a motion with a base_radius, or an outline")
        if self.motion is None and self.base_radius is not None:
            raise ValueError("base_radius: an outline has its own; leave it out")
        if self.motion is not None and self.base_radius is None:
            raise ValueError("base_radius: missing: the motion is a lift over the base circle")
        if self.conjugate is not None and self.motion is None:
            raise ValueError("conjugate: a pair of cams follows from a motion, not from an outline")
        return self

    def beside(self, folder: Path) -> Cam:
        """Return the cam with what its files hold, relative to a folder.

        Raises
        ------
        InputError, ValueError
            If a file cannot be used.
        """
        motion = None if self.motion is None else [law.beside(folder) for law in self.laws]
        outline = None if self.outline is None else self.shape.beside(folder)
        own = {name: getattr(self, name) for name in type(self).model_fields}
        return type(self).model_construct(**{**own, "motion": motion, "outline": outline})

    @property
    def touch(self) -> Follower:
        """The follower."""
        assert_kind(self.follower, Follower)
        return self.follower  # type: ignore[return-value]

    @property
    def laws(self) -> list[MotionLaw]:
        """The motion laws, none of an outline."""
        return list(self.motion or [])  # type: ignore[arg-type]

    @property
    def shape(self) -> CamOutline:
        """The outline."""
        assert_kind(self.outline, CamOutline)
        return self.outline  # type: ignore[return-value]

    @cached_property
    def curve(self) -> PieceCurve | None:
        """Lift over a turn; None of an outline."""
        return None if self.motion is None else motion_of(self.laws)

    @cached_property
    def start(self) -> float:
        """Coordinate of the follower without lift [m or rad]."""
        if self.base_radius is not None:
            return self.touch.start(self.base_radius)
        return self.lowest()[0]

    def moving(self, theta: Array) -> FollowerMotion:
        """Return the motion of the follower at angles of the cam [rad]."""
        theta = np.asarray(theta, dtype=float)
        if self.curve is None:
            return self.shape.motion(self.touch, theta)
        lift, slope, second, _ = self.curve.derivatives(np.mod(theta, TURN))
        return FollowerMotion(theta, self.start + lift, slope, second)

    def geometry(self, theta: Array) -> CamGeometry:
        """Return the geometry at angles of the cam [rad]."""
        return geometry_of(self.touch, self.moving(theta))

    def samples(self, count: int) -> Array:
        """Return equally distant angles of a turn, its end included [rad]."""
        return np.linspace(0.0, TURN, count + 1)

    def lowest(self) -> tuple[float, float]:
        """Return the least coordinate on an outline and its angle [rad].

        It is sought more finely about the least sample.
        """
        theta = self.samples(1440)
        for _ in range(_ZOOMS):
            values = self.shape.motion(self.touch, theta).coordinate
            k = int(np.argmin(values))
            near, at = float(theta[1] - theta[0]), float(theta[k])
            theta = at + near * np.linspace(-1.0, 1.0, 33)
        return float(values.min()), at

    def with_lowest_at(self, theta: float) -> Self:
        """Return the cam whose least coordinate is known to be near an angle [rad].

        Its numbers may step into the complex plane. At a corner, as where a face lies on a straight
        flank, the least coordinate is where both sides meet.
        """
        near = self.shape.motion(self.touch, theta + _BESIDE * np.array([-1.0, 1.0]))
        (before, after), (falls, rises) = near.coordinate, near.slope
        least = 0.5 * (before + after)
        if abs(rises - falls) > _LEVEL * abs(least):
            way = (before - after + 2.0 * _BESIDE * rises) / (rises - falls)
            least = before + falls * way
        found = self.model_copy()
        found.__dict__["start"] = least
        return found


def assert_kind(item: Any, kind: type) -> None:
    """Refuse what is no entry of the right catalogue."""
    if not isinstance(item, kind):
        raise TypeError(f"expected a {kind.__name__}, found {type(item).__name__}")
