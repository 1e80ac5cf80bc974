"""What a wheel's contact with its rail depends on, as a key of caches."""

from __future__ import annotations

import hashlib

import numpy as np

from vehicledyn.rail.geometry.contact_geometry import MountedWheel, Rail


def identity_of(wheel: MountedWheel, rail: Rail) -> str:
    """Return a digest of the shapes and places of a wheel and its rail."""
    numbers = (wheel.radius, wheel.half_distance, rail.inclination, *rail.origin)
    digest = hashlib.sha256(repr((wheel.profile.name, rail.profile.name, numbers)).encode())
    surface = rail.surface
    for array in (*wheel.scan, surface.places, surface.left, surface.right):
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()
