"""The railway track: design, alignment, tables, and what runs along it."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
