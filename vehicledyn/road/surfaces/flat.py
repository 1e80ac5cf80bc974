"""Level ground."""

from __future__ import annotations

from typing import ClassVar

from vehicledyn.base.registry import register
from vehicledyn.road.surfaces.surface import RoadSurface
from vehicledyn.symbolic.ops import Scalar


@register("road", "flat")
class Flat(RoadSurface):
    """Level ground, z = 0 everywhere."""

    is_flat: ClassVar[bool] = True

    def height(self, x: Scalar, y: Scalar) -> Scalar:
        """Return zero [m]."""
        return 0.0

    def gradient(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
        """Return no slope."""
        return 0.0, 0.0
