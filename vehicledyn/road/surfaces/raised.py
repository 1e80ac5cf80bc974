"""A road surface lifted by a height, and tilted along x, that may be symbols."""

from __future__ import annotations

from typing import Any, ClassVar

from vehicledyn.road.surfaces.surface import RoadSurface
from vehicledyn.symbolic.ops import Scalar


class RaisedRoad(RoadSurface):
    """The ground z = base(x, y) + rise with the slope of the base and ``slope`` along x.

    For small rises under one wheel only: the slope does not grow into height along the road.
    """

    base: Any
    rise: Any
    slope: Any = 0.0

    def height(self, x: Scalar, y: Scalar) -> Scalar:
        """Return the height of the ground [m]."""
        return self.base.height(x, y) + self.rise

    def gradient(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
        """Return the two slopes [1]."""
        along, across = self.base.gradient(x, y)
        return along + self.slope, across

    def friction(self, x: Scalar, y: Scalar) -> Scalar:
        """Return the friction of the base [1]."""
        return self.base.friction(x, y)


class RaisedPlane(RaisedRoad):
    """A plane that stays one."""

    is_flat: ClassVar[bool] = True


def raised(surface: RoadSurface, rise: Scalar, slope: Scalar = 0.0) -> RoadSurface:
    """Return a surface lifted by a rise [m] and tilted by a slope along x [1]."""
    chosen = RaisedPlane if surface.is_flat else RaisedRoad
    return chosen.model_construct(base=surface, rise=rise, slope=slope, soil=surface.soil)
