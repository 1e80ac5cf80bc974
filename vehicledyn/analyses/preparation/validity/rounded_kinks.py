"""Report balanced starts where the frame of a track rounds what its design does at once.

A vehicle is balanced in the smooth frame that carries it. Where curvature, cant or gradient begin
to change that frame and the rails differ, and what nothing centres finds its balance aside.
"""

from __future__ import annotations

import numpy as np

from vehicledyn.analyses.preparation.curved_starts import axle_places
from vehicledyn.analyses.preparation.prepare import AssembledPoint
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.base.units import shown
from vehicledyn.rail.track.riding_line import rounding

NOTICED = 4e-6
"""Difference of the frames within half a metre from which on a balance is reported [m or rad].

It is passed some five metres before a change, where wheels stand 0.1 mm aside at most.
"""


def rounded_kinks(prepared: Prepared, start: AssembledPoint) -> list[str]:
    """Return a sentence about axles that a balanced start has near a change of the track."""
    track, axles_at = axle_places(prepared, start.state, start.unknowns)
    if track is None:
        return []
    sizes = rounding(track.line, np.array(list(axles_at.values())))
    found = [
        f"{name} at {shown(at, 'm')}"
        for (name, at), size in zip(axles_at.items(), sizes, strict=True)
        if size > NOTICED
    ]
    if not found:
        return []
    axles = ", ".join(found)
    return [
        f"warning: balanced where the track begins to change ({axles}): the frame of the balance "
        "rounds such places over some metres, so that wheels which hardly anything centres stand "
        "up to 5 mm aside and wheel loads are off by up to 3 %; start some ten metres away from "
        "where curvature, cant or gradient begin to change"
    ]
