"""Wheels on the ground: surfaces, contact point, slip, tyre laws and the road wheel."""

from vehicledyn.road import surfaces, tyres

__all__ = ["surfaces", "tyres"]
