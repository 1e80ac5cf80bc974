"""Vehicles: each a module that registers itself and a data file with its parameters."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
