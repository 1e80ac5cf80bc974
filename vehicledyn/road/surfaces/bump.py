"""A single cosine bump across the road."""

from __future__ import annotations

import math
from typing import Literal

from pydantic import Field

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.surfaces.surface import RoadSurface
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


@register("road", "bump")
class Bump(RoadSurface):
    """Cosine bump z = h/2 (1 - cos(2π (x - start)/length)) on otherwise level ground.

    In anti-phase the left half of the road (y > 0) has the bump and the right half (y < 0)
    a hole of the same shape. Height and slope are continuous; the curvature jumps at both
    ends, and in anti-phase the height itself jumps along y = 0, where no wheel should run.
    """

    crest: float = quantity("m", "Height h of the crest; negative for a hole")
    length: float = quantity("m", "Length along world x", gt=0)
    start: float = quantity("m", "World x where the bump begins")
    mode: Literal["in_phase", "anti_phase"] = Field(
        default="in_phase", description="Whether the right half of the road has the bump, or a hole"
    )

    def height(self, x: Scalar, y: Scalar) -> Scalar:
        """Return the height of the ground [m]."""
        return self._side(y) * 0.5 * self.crest * (1.0 - ops.cos(self._phase(x)))

    def gradient(self, x: Scalar, y: Scalar) -> tuple[Scalar, Scalar]:
        """Return the slope along x [1]; the slope along y is zero."""
        steepness = math.pi * self.crest / self.length
        return self._side(y) * steepness * ops.sin(self._phase(x)), 0.0

    def _phase(self, x: Scalar) -> Scalar:
        part = ops.minimum(ops.maximum((x - self.start) / self.length, 0.0), 1.0)
        return 2.0 * math.pi * part

    def _side(self, y: Scalar) -> Scalar:
        return 1.0 if self.mode == "in_phase" else ops.where(y < 0.0, -1.0, 1.0)
