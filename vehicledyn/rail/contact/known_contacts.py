"""Elastic contacts that were made before: equal wheels on equal rails have one and the same."""

from __future__ import annotations

import hashlib

import numpy as np

from vehicledyn.base.bounded_cache import BoundedCache
from vehicledyn.rail.contact.elastic_contact import ElasticContact
from vehicledyn.rail.geometry.contact_geometry import Rail, Wheel

_KNOWN: BoundedCache[str, ElasticContact] = BoundedCache(32)


def contact_of(wheel: Wheel, rail: Rail, attack: float) -> ElasticContact:
    """Return the contact of a wheel and its rail, see :meth:`ElasticContact.of`."""
    key = _identity(wheel, rail, attack)
    return _KNOWN.get(key, lambda: ElasticContact.of(wheel, rail, attack))


def _identity(wheel: Wheel, rail: Rail, attack: float) -> str:
    """Return a digest of all that a contact depends on."""
    numbers = (wheel.radius, wheel.half_distance, rail.inclination, *rail.origin, attack)
    digest = hashlib.sha256(repr((wheel.profile.name, rail.profile.name, numbers)).encode())
    surface = rail.surface
    for array in (*wheel.scan, surface.places, surface.left, surface.right):
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()
