"""Motion laws of cams: what a follower does over an angle of the cam, one law a module."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
