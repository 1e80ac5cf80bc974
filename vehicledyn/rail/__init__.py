"""Wheel on rail: profiles, contact geometry, creep."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
