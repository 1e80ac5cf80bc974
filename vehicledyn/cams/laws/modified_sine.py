"""Modified sine: sines of acceleration of two periods."""

from __future__ import annotations

import math

from vehicledyn.base.registry import register
from vehicledyn.cams.motion_law import MotionLaw
from vehicledyn.cams.pieces import PieceCurve, from_accelerations


@register("motion_law", "modified_sine")
class ModifiedSine(MotionLaw):
    """Modified sine: quarter sines over an eighth at both ends, half a sine between."""

    def curve(self) -> PieceCurve:
        """Return the curve; its greatest acceleration is 5.528."""
        quarter = 0.5 * math.pi
        return from_accelerations(
            [
                (0.125, (1.0, quarter, 0.0)),
                (0.75, (1.0, math.pi, quarter)),
                (0.125, (1.0, quarter, -quarter)),
            ]
        )
