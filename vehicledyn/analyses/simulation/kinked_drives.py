"""Report driven coordinates whose rates jump: what hangs on them does not feel the impulse."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.runnable import Subject
from vehicledyn.base.units import shown
from vehicledyn.multibody.elements.drives import TimeLaw
from vehicledyn.multibody.model.parts import Clock
from vehicledyn.multibody.model.system import System
from vehicledyn.rail.track.follower import TrackFollower
from vehicledyn.symbolic import ops

Vector = NDArray[np.float64]

_SAMPLES, _CLOSEST, _APART = 401, 8, 0.1
"""Times that are looked at, and how many intervals are halved until a jump shows, if the change
there is by this part of it larger than those beside it."""
_OFF_ROUND = 0.381966
"""Part of an interval by which times are shifted: at a kink itself a slope is the mean of both."""
_HALVINGS = 30
_JUMP = 1e-6
"""Part of the largest value that a jump must have to count."""


def kinked_drives(subject: Subject, duration: float) -> list[str]:
    """Return a line for each driven coordinate that jumps, or whose rate does, in a run [s].

    Its acceleration is infinite there for no time. Steps pass over it, so that bodies which the
    coordinate carries keep their rates relative to it instead of their momentum. The coordinate
    that a manoeuvre steers by moves as its standard has it, and is left out.
    """
    system = subject.system
    names, evaluate = _motions(system, but=subject.ports.steering)
    if not names:
        return []
    times = duration * (np.arange(_SAMPLES) + _OFF_ROUND) / _SAMPLES
    found = np.array([evaluate(t) for t in times])
    units = {joint.name: joint.unit for joint in system.joints()}
    lines = []
    for k, name in enumerate(names):
        for row, what, unit in ((0, "", units[name]), (1, "the rate of ", f"{units[name]}/s")):
            jump = _first_jump(times, found[:, row, k], partial(_entry, evaluate, row, k))
            if jump is not None:
                lines.append(
                    f"{what}'{name}' jumps by {shown(jump[1], unit)} at t = {jump[0]:.6g} s: what "
                    "it carries does not feel that impulse; give its law a continuous rate, such "
                    "as 'ramp' has"
                )
                break
    return lines


def _motions(system: System, but: str) -> tuple[list[str], Callable[[float], Vector]]:
    """Return the coordinates that follow laws of time, and their positions over rates.

    The latter are a function of time; the coordinate ``but`` is left out.
    """
    time = ops.symbol("time")
    parts = [part for part in system.parts if isinstance(part, TimeLaw | TrackFollower)]
    moved = [item for part in parts for item in part.motions(Clock(time, {})).items()]
    motions = [(name, motion) for name, motion in moved if name != but]
    entries = system.table.entries
    values = np.array([entry.value for entry in entries])
    symbols = ops.column([entry.symbol for entry in entries])
    positions, rates = (
        ops.column([ops.scalar(getattr(motion, what)) for _, motion in motions])
        for what in ("position", "velocity")
    )
    both = ops.numeric([time, symbols], ops.stacked(positions, rates))
    return [name for name, _ in motions], lambda t: both(t, values).reshape(2, -1)


def _entry(evaluate: Callable[[float], Vector], row: int, column: int, time: float) -> float:
    return float(evaluate(time)[row, column])


def _first_jump(
    times: Vector, values: Vector, at: Callable[[float], float]
) -> tuple[float, float] | None:
    """Return time and size of the first jump, None where there is none."""
    steps = np.abs(np.diff(values))
    beside = np.minimum(np.append(steps[1:], 0.0), np.insert(steps[:-1], 0, 0.0))
    least = _JUMP * float(np.abs(values).max())
    sharp = (steps > least) & (steps - beside > _APART * steps)
    closest = [k for k in np.argsort(steps - beside)[-_CLOSEST:] if sharp[k]]
    jumps = [_closed_in(times[k], times[k + 1], at) for k in closest]
    return min((jump for jump in jumps if jump[1] > least), default=None)


def _closed_in(begin: float, end: float, at: Callable[[float], float]) -> tuple[float, float]:
    """Return where within an interval a rate changes most, and by how much in no time."""
    first, last = at(begin), at(end)
    for _ in range(_HALVINGS):
        middle = 0.5 * (begin + end)
        value = at(middle)
        if abs(value - first) > abs(last - value):
            end, last = middle, value
        else:
            begin, first = middle, value
    return end, abs(last - first)
