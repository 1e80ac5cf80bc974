"""Patches of other friction on the ground."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
