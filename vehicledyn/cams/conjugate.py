"""Conjugate cams: a second cam on the same shaft that moves the follower back.

The follower has two rollers or faces, one on each cam, so that one of the cams pushes at any time
and no spring is needed. With the coordinate c(θ) of the first roller that of the second is D - c:
D is the distance of the two along the slide, or the angle between the arms of a rocker. The second
roller of a slide is on the other side of the shaft, in axes turned by half a turn.
"""

from __future__ import annotations

from typing import Any

from pydantic import model_validator

from vehicledyn.base.parameters import ParameterSet, part, quantity


class Conjugate(ParameterSet):
    """The second roller or face of a follower, and where it is."""

    in_equations = True

    follower: ParameterSet = part("cam_follower", "What touches the second cam")
    distance: float | None = quantity(
        "m", "Distance of the two centres or faces along the slide", default=None, gt=0.0
    )
    angle: float | None = quantity(
        "rad", "Angle between the two arms or faces of a rocker", default=None, gt=0.0
    )

    @model_validator(mode="after")
    def _one_place(self) -> Any:
        if (self.distance is None) == (self.angle is None):
            raise ValueError("give the distance of a slide or the angle of a rocker")
        return self

    @property
    def apart(self) -> float:
        """Sum of the two coordinates [m or rad]."""
        return self.distance if self.distance is not None else self.angle or 0.0
