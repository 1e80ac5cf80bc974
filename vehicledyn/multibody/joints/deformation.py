"""A coordinate of the deformation of a body, which moves points of the body and not a joint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from vehicledyn.base.registry import register
from vehicledyn.multibody.joints.joint_type import Axes, JointType, choice

DEFORMATION = "deformation"
"""Kind of the coordinates; bodies give them to themselves, no file names them as a joint."""


@register("deformation_type", "deformation")
@dataclass(frozen=True)
class Deformation(JointType):
    """Amplitude of a shape; bodies give such coordinates to themselves."""

    measure: Literal["m", "rad", "1"] = choice("Unit of the amplitude")

    @property
    def unit(self) -> str:  # type: ignore[override]
        """Unit of the coordinate."""
        return self.measure

    @property
    def makes_link(self) -> bool:
        """Whether the coordinate has a link of its own: no."""
        return False

    @property
    def force_unit(self) -> str:
        """Unit of the force on the coordinate, work over amplitude."""
        return {"m": "N", "rad": "N*m", "1": "N*m"}[self.measure]

    def motion(self, q: object) -> Axes:
        """Return no axes: the points of the body move as it says itself."""
        return Axes()

    def is_turned_by_mirror(self, axis: int) -> bool:
        """Return False; the body mirrors its own shapes."""
        return False
