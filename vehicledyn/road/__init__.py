"""Wheels on the ground: surfaces, contact point, slip, tyre laws and the road wheel."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
