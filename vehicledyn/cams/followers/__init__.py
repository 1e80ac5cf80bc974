"""Followers of cams: what touches the cam and how it is guided."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
