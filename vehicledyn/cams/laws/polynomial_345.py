"""The polynomial of degree 5 without velocity and acceleration at its ends."""

from __future__ import annotations

from vehicledyn.base.registry import register
from vehicledyn.cams.motion_law import MotionLaw
from vehicledyn.cams.pieces import CurvePiece, PieceCurve


@register("motion_law", "polynomial_345")
class Polynomial345(MotionLaw):
    """3-4-5 polynomial, y = 10 u³ - 15 u⁴ + 6 u⁵."""

    def curve(self) -> PieceCurve:
        """Return the polynomial."""
        return PieceCurve((CurvePiece(0.0, 1.0, (0.0, 0.0, 0.0, 10.0, -15.0, 6.0)),))
