"""Contacts of bodies: by constraint, compliant, and rigid with impacts."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
