"""Modified trapezoid: constant accelerations joined by sines."""

from __future__ import annotations

import math

from vehicledyn.base.registry import register
from vehicledyn.cams.motion_law import MotionLaw
from vehicledyn.cams.pieces import PieceCurve, from_accelerations


@register("motion_law", "modified_trapezoid")
class ModifiedTrapezoid(MotionLaw):
    """Modified trapezoid: accelerations constant over quarters, with sines between."""

    def curve(self) -> PieceCurve:
        """Return the curve; its greatest acceleration is 4.888."""
        quarter = 0.5 * math.pi
        return from_accelerations(
            [
                (0.125, (1.0, quarter, 0.0)),
                (0.25, 1.0),
                (0.25, (1.0, math.pi, quarter)),
                (0.25, -1.0),
                (0.125, (1.0, quarter, -quarter)),
            ]
        )
