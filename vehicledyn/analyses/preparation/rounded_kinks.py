"""Report balanced starts where the frame of a track rounds what its design does at once.

A vehicle is balanced in the smooth frame that carries it. Where curvature, cant or gradient begin
to change that frame and the rails differ, and what nothing centres finds its balance aside.
"""

from __future__ import annotations

import numpy as np

from vehicledyn.analyses.preparation.prepare import Point
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.base.units import shown
from vehicledyn.rail.track.riding_line import rounding
from vehicledyn.rail.track.running import TRACK_POSITION
from vehicledyn.rail.track.track import Track

NOTICED = 4e-6
"""Difference of the frames within half a metre from which on a balance is reported [m or rad].

It is passed some five metres before a change, where wheels stand 0.1 mm aside at most.
"""


def rounded_kinks(prepared: Prepared, start: Point) -> list[str]:
    """Return a sentence about axles that a balanced start has near a change of the track."""
    tracks = [track for part in prepared.subject.system.parts if (track := _track(part))]
    suffix = f".{TRACK_POSITION}"
    names = [channel.name for channel in prepared.equations.channels]
    chosen = [k for k, name in enumerate(names) if name.endswith(suffix)]
    if not tracks or not chosen or tracks[0].is_straight:
        return []
    outputs = prepared.kernel.outputs(prepared.subject.balance_time, start.state, start.unknowns)
    places = np.array([float(outputs[k]) for k in chosen])
    found = [
        k
        for k, size in zip(chosen, rounding(tracks[0].line, places), strict=True)
        if size > NOTICED
    ]
    if not found:
        return []
    axles = ", ".join(
        f"{names[k].removesuffix(suffix)} at {shown(float(outputs[k]), 'm')}" for k in found
    )
    return [
        f"warning: balanced where the track begins to change ({axles}): the frame of the balance "
        "rounds such places over some metres, so that wheels which hardly anything centres stand "
        "up to 5 mm aside and wheel loads are off by up to 3 %; start some ten metres away from "
        "where curvature, cant or gradient begin to change"
    ]


def _track(part: object) -> Track | None:
    """Return what the wheels of a part run on, None of one that has none."""
    found = getattr(getattr(part, "wheels", part), "track", None)
    return found if isinstance(found, Track) else None
