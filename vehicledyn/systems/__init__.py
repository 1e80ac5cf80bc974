"""Systems written in YAML alone: read, validate, expand, build, write back."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
