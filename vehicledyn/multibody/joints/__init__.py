"""Types of joints, one file each: what a joint lets move, and along which axes."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
