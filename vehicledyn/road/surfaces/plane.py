"""Inclined plane: a constant grade and a constant bank."""

from __future__ import annotations

from typing import ClassVar

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.surfaces.surface import RoadSurface
from vehicledyn.symbolic.ops import Scalar


@register("road", "plane")
class Plane(RoadSurface):
    """Inclined plane, z = height + slope_x x + slope_y y."""

    is_flat: ClassVar[bool] = True

    slope_x: float = quantity("1", "Rise along world x per metre, uphill positive", ge=-2, le=2)
    slope_y: float = quantity(
        "1", "Rise along world y per metre, up to the left positive", ge=-2, le=2
    )
    level: float = quantity("m", "Height at the origin of the world", default=0.0)

    def height(self, x: Scalar, y: Scalar) -> Scalar:
        """Return the height of the plane [m]."""
        return self.level + self.slope_x * x + self.slope_y * y

    def gradient(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
        """Return the two constant slopes [1]."""
        return self.slope_x, self.slope_y
