"""Elastic contacts that were made before: equal wheels on equal rails have one and the same."""

from __future__ import annotations

from vehicledyn.base.bounded_cache import BoundedCache
from vehicledyn.rail.contact.contact_identity import identity_of
from vehicledyn.rail.contact.elastic_contact import ElasticContact
from vehicledyn.rail.geometry.contact_geometry import MountedWheel, Rail

_KNOWN: BoundedCache[tuple[str, float], ElasticContact] = BoundedCache(32)


def contact_of(wheel: MountedWheel, rail: Rail, attack: float) -> ElasticContact:
    """Return the contact of a wheel and its rail, see :meth:`ElasticContact.of`."""
    key = (identity_of(wheel, rail), attack)
    return _KNOWN.get(key, lambda: ElasticContact.of(wheel, rail, attack))
