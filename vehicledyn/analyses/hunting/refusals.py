"""What no hunting study can be made of, found before anything is derived."""

from __future__ import annotations

import numpy as np

from vehicledyn.analyse.periodic.autonomous_form import TIMES
from vehicledyn.analyses.hunting.start import HuntSettings, parameter_index, span_of
from vehicledyn.analyses.preparation.prepared import Derived
from vehicledyn.base.errors import InputError
from vehicledyn.multibody.model.system import System
from vehicledyn.rail.track.follower import TrackFollower
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

_EVEN = 1e-9
"""Change of curvature [1/m], cant [1] or rails [m] that counts as none."""


def check_subject(derived: Derived, settings: HuntSettings) -> None:
    """Refuse parameters, ranges and tracks of which no study can be made.

    Raises
    ------
    InputError
        If there is no such parameter, the range is none of it, or the track changes on the way.
    """
    system = derived.subject.system
    entries = system.table.entries
    index = parameter_index([e.name for e in entries], settings.parameter, system.name)
    span_of(entries[index].unit, settings)
    for part in system.parts:
        if isinstance(part, TrackFollower) and _changes(part, system):
            raise InputError(
                f"model '{system.name}' depends on time, as the track of '{part.name}' changes on "
                "the way: limit cycles are those of free motions; take a straight, even track"
            )


def _changes(part: TrackFollower, system: System) -> bool:
    """Return whether a track is another one farther on for the frame that follows it."""
    track = part.track
    if track.is_straight and track.is_perfect:
        return False
    time = ops.symbol("time")
    s = part.law(time)
    frame = track.frame(s)
    seen: list[Scalar] = [
        frame.stretch,
        frame.rotation[2, 1],
        *(frame.turning[k] for k in range(3)),
    ]
    seen += [*track.rail_shift("left", s), *track.rail_shift("right", s)]
    entries = system.table.entries
    symbols = ops.column([entry.symbol for entry in entries])
    evaluate = ops.numeric([time, symbols], ops.column([ops.scalar(item) for item in seen]))
    values = np.array([entry.value for entry in entries])
    rows = np.array([evaluate(instant, values).ravel() for instant in TIMES])
    return bool(np.ptp(rows, axis=0).max() > _EVEN)
