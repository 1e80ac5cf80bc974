"""Parabolic motion: constant acceleration, then as much deceleration."""

from __future__ import annotations

from vehicledyn.base.registry import register
from vehicledyn.cams.motion_law import MotionLaw
from vehicledyn.cams.pieces import PieceCurve, from_accelerations


@register("motion_law", "parabolic")
class Parabolic(MotionLaw):
    """Constant acceleration over one half, as much deceleration over the other."""

    def curve(self) -> PieceCurve:
        """Return two parabolas."""
        return from_accelerations([(0.5, 1.0), (0.5, -1.0)])
