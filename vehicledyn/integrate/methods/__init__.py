"""Catalogue of integration methods: settings read from a scenario, one file each."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
