"""Say what helps where a vehicle finds no balance in a curve, in which it stands at the start.

Bodies start along the tangent of the frame that carries them, axles far from it beside the rails.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.base.units import shown
from vehicledyn.rail.track.running import TRACK_POSITION
from vehicledyn.rail.track.track import Track
from vehicledyn.symbolic import ops


def axle_places(
    prepared: Prepared, state: NDArray[np.float64], unknowns: NDArray[np.float64]
) -> tuple[Track | None, dict[str, float]]:
    """Return the track that curves, None if there is none, and the chainage of each axle [m]."""
    tracks = [track for part in prepared.subject.system.parts if (track := _track(part))]
    suffix = f".{TRACK_POSITION}"
    names = [channel.name for channel in prepared.equations.channels]
    chosen = [k for k, name in enumerate(names) if name.endswith(suffix)]
    if not tracks or not chosen or tracks[0].is_straight:
        return None, {}
    outputs = prepared.kernel.outputs(prepared.subject.balance_time, state, unknowns)
    return tracks[0], {names[k].removesuffix(suffix): float(outputs[k]) for k in chosen}


def curve_advice(
    prepared: Prepared, state: NDArray[np.float64], unknowns: NDArray[np.float64]
) -> str:
    """Return a clause for the message that no balance is found, empty where no curve is."""
    track, places = axle_places(prepared, state, unknowns)
    if track is None:
        return ""
    s = ops.symbol("s")
    curvature = ops.numeric([s], track.line.curvature(s))
    sharpest = max(abs(float(np.squeeze(curvature(at)))) for at in places.values())
    if sharpest == 0.0:
        return ""
    return (
        f"; it starts along the tangent of a curve of {shown(1.0 / sharpest, 'm')}, beside the "
        "rails: give its bodies as 'initial' the places that they have at the end of a run which "
        "enters the curve from straight track"
    )


def _track(part: object) -> Track | None:
    """Return what the wheels of a part run on, None of one that has none."""
    found = getattr(getattr(part, "wheels", part), "track", None)
    return found if isinstance(found, Track) else None
