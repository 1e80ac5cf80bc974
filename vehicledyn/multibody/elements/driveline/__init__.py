"""Elements of drivelines: engine, clutches, converters and shafts."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
