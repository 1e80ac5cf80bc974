"""Where on its track a part was when an event of it ended a run."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vehicledyn.rail.track.running import TRACK_POSITION

if TYPE_CHECKING:
    from vehicledyn.analyses.preparation.prepared import Prepared

Vector = NDArray[np.float64]


def track_place(
    prepared: Prepared, event: str, time: float, state: Vector, unknowns: Vector
) -> float | None:
    """Return the arc coordinate of the part that an event belongs to [m]; None off the rails.

    Parameters
    ----------
    prepared
        The system.
    event
        Dotted name of the event, which begins with that of its part.
    time, state, unknowns
        The moment [s] and the point.
    """
    for number, channel in enumerate(prepared.equations.channels):
        part, _, quantity = channel.name.rpartition(".")
        if quantity == TRACK_POSITION and event.startswith(f"{part}."):
            return float(prepared.kernel.outputs(time, state, unknowns)[number])
    return None
