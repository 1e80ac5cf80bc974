"""Manoeuvres and drivers: what a vehicle is asked to do, each a module that registers itself."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
