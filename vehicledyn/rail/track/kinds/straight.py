"""Straight, level track."""

from __future__ import annotations

from pathlib import Path

from vehicledyn.base.registry import register
from vehicledyn.rail.track.track import StraightLine, Track
from vehicledyn.rail.track.track_set import TrackSet


@register("track", "straight")
class StraightTrack(TrackSet):
    """Straight, level track along x, without end."""

    def track(self, folder: Path) -> Track:
        """Return the track."""
        return self.on(folder, StraightLine())
