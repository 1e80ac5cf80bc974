"""Manoeuvres that brake: on the straight, on split friction, in a turn."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
