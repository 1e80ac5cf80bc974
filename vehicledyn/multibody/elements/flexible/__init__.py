"""Elements that deform: beams, bars, bodies from finite elements, and loads that travel on them."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
