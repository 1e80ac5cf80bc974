"""Cycloidal motion: a full sine of acceleration."""

from __future__ import annotations

import math

from vehicledyn.base.registry import register
from vehicledyn.cams.motion_law import MotionLaw
from vehicledyn.cams.pieces import CurvePiece, PieceCurve


@register("motion_law", "cycloidal")
class Cycloidal(MotionLaw):
    """Cycloidal motion, y = u - sin(2 π u) / (2 π), of continuous acceleration."""

    def curve(self) -> PieceCurve:
        """Return the line less the sine."""
        turn = 2.0 * math.pi
        return PieceCurve((CurvePiece(0.0, 1.0, (0.0, 1.0), ((-1.0 / turn, turn, 0.0),)),))
