"""Manoeuvres by tables and records of time."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
