"""Catalogue of manoeuvres, one file each."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
