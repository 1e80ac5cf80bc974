"""Elements of steerings: torsion bar and power assistance."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
