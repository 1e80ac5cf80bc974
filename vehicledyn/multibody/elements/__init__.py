"""Elements of general systems: springs, bushings, links, drives, transmissions, sensors."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
