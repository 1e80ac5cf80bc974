"""Outlines of cams that are given as such: circles, arcs and lines, measured points."""

from vehicledyn.base.registry import discover

discover(__name__, __path__)
