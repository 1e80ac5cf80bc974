"""Wheel on the ground: contact point, slip, relaxation, the wheel as a part."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
