"""Followers of face and barrel cams: they slide along the axis of the cam."""

from __future__ import annotations

from typing import ClassVar, Literal

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.cams.follower import Array, Follower


@register("cam_follower", "axial_roller")
class AxialRoller(Follower):
    """A roller that slides along the axis of the cam, on a face or in a barrel.

    The cam is cut along a cylinder about its axis. Developed, with x = R θ, the pitch curve is
    the motion itself; the axis of the roller is radial. Its coordinate is the height.
    """

    distance: float = quantity("m", "Distance R of the roller's middle from the axis", gt=0.0)
    radius: float = quantity("m", "Radius of the roller", gt=0.0)
    shape: ClassVar[Literal["point", "line", "axial"]] = "axial"

    @property
    def roller(self) -> float:
        """Radius of the roller [m]."""
        return self.radius

    def start(self, base_radius: float) -> float:
        """Return the height of the centre at no lift [m]."""
        return base_radius + self.radius

    def check_reach(self, coordinate: Array) -> None:
        """Refuse nothing."""
