"""Tell of wheels on rails that stand: the laws of their creep hold for rolling."""

from __future__ import annotations

from vehicledyn.analyses.preparation.prepare import Point
from vehicledyn.analyses.preparation.prepared import Prepared

_SLOW = 0.1
"""Speed along the track below which a wheel counts as standing [m/s]."""
_SPEED = ".track_speed"


def standing_wheels(prepared: Prepared, start: Point) -> list[str]:
    """Return a line that tells which wheels on rails stand at the start of a run."""
    channels = prepared.equations.channels
    found = [k for k, channel in enumerate(channels) if channel.name.endswith(_SPEED)]
    if not found:
        return []
    values = prepared.kernel.outputs(0.0, start.state, start.unknowns)
    names = [channels[k].name.removesuffix(_SPEED) for k in found if abs(values[k]) < _SLOW]
    if not names:
        return []
    return [
        f"wheels on rails stand at the start: {', '.join(names)}; creep forces are those of "
        f"rolling wheels, below {_SLOW:g} m/s they are stiff and chatter in fixed steps: give a "
        "speed, or use an implicit solver and keep to the vertical motion"
    ]
