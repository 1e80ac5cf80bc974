"""Catalogue of drivers who steer along a path, one file each."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
