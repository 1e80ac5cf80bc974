"""Uniform motion: constant velocity."""

from __future__ import annotations

from vehicledyn.base.registry import register
from vehicledyn.cams.motion_law import MotionLaw
from vehicledyn.cams.pieces import CurvePiece, PieceCurve


@register("motion_law", "uniform")
class Uniform(MotionLaw):
    """Constant velocity, y = u; its velocity jumps where what joins it has another one."""

    def curve(self) -> PieceCurve:
        """Return the line."""
        return PieceCurve((CurvePiece(0.0, 1.0, (0.0, 1.0)),))
