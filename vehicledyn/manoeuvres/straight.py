"""Straight on: the rack is held; for bumps, standing still and coasting."""

from __future__ import annotations

from vehicledyn.base.registry import register
from vehicledyn.manoeuvres.manoeuvre import RoadManoeuvre


@register("manoeuvre", "straight")
class Straight(RoadManoeuvre):
    """Hold the rack in the middle."""
