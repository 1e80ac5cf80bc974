"""Harmonic motion: half a cosine."""

from __future__ import annotations

import math

from vehicledyn.base.registry import register
from vehicledyn.cams.motion_law import MotionLaw
from vehicledyn.cams.pieces import CurvePiece, PieceCurve


@register("motion_law", "harmonic")
class Harmonic(MotionLaw):
    """Simple harmonic motion, y = (1 - cos π u) / 2; its acceleration jumps at both ends."""

    def curve(self) -> PieceCurve:
        """Return half a cosine."""
        return PieceCurve((CurvePiece(0.0, 1.0, (0.5,), ((-0.5, math.pi, 0.5 * math.pi),)),))
