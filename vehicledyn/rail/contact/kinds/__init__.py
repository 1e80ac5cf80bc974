"""Catalogue of models of wheel and rail in contact, one file each."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
