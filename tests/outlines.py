"""Outlines of profiles in closed form."""

from dataclasses import dataclass
from typing import Any

from vehicledyn.rail.profiles.outline import OutlinePoint
from vehicledyn.symbolic import ops


@dataclass(frozen=True)
class ConeOutline:
    """A cone: z = -γ y, the rolling radius falling outwards with the slope γ [1]."""

    slope: Any

    def at(self, place):
        return OutlinePoint(-self.slope * place, -self.slope, 0.0)


@dataclass(frozen=True)
class ArcOutline:
    """The upper side of a circle of a radius about a centre (y, z) [m]."""

    radius: Any
    centre: tuple[Any, Any]

    def at(self, place):
        across = place - self.centre[0]
        up = ops.sqrt(self.radius * self.radius - across * across)
        bend = -self.radius * self.radius / (up * up * up)
        return OutlinePoint(self.centre[1] + up, -across / up, bend)
