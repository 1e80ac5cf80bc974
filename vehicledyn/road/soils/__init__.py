"""Catalogue of soils that wheels sink into."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
