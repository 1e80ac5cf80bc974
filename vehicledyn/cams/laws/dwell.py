"""Dwell: the follower rests."""

from __future__ import annotations

from typing import Any

from pydantic import model_validator

from vehicledyn.base.registry import register
from vehicledyn.cams.motion_law import MotionLaw
from vehicledyn.cams.pieces import CurvePiece, PieceCurve


@register("motion_law", "dwell")
class Dwell(MotionLaw):
    """Rest over an angle."""

    @model_validator(mode="after")
    def _one_rise(self) -> Any:
        if self.lift is not None or self.swing is not None:
            raise ValueError("a dwell has neither lift nor swing; take another motion law")
        return self

    def curve(self) -> PieceCurve:
        """Return a constant."""
        return PieceCurve((CurvePiece(0.0, 1.0, (0.0,)),))
