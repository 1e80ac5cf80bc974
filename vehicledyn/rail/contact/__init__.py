"""Wheels on rails as parts: elastic and rigid contact."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
