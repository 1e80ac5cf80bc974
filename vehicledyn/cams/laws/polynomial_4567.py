"""The polynomial of degree 7 without velocity, acceleration and jerk at its ends."""

from __future__ import annotations

from vehicledyn.base.registry import register
from vehicledyn.cams.motion_law import MotionLaw
from vehicledyn.cams.pieces import CurvePiece, PieceCurve


@register("motion_law", "polynomial_4567")
class Polynomial4567(MotionLaw):
    """4-5-6-7 polynomial, y = 35 u⁴ - 84 u⁵ + 70 u⁶ - 20 u⁷."""

    def curve(self) -> PieceCurve:
        """Return the polynomial."""
        return PieceCurve((CurvePiece(0.0, 1.0, (0.0, 0.0, 0.0, 0.0, 35.0, -84.0, 70.0, -20.0)),))
