"""What the accuracy of a run is judged by: the key figures of what runs."""

from __future__ import annotations

from numbers import Real

import numpy as np

from vehicledyn.analyses.preparation.runnable import Subject, Vector
from vehicledyn.integrate.channel_ranges import watched_channels
from vehicledyn.integrate.judged_quantities import Judged
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.symbolic.equations import Equations

_OF_CHECKS = ("energy_drift", "largest_loop_gap", "largest_loop_speed")
"""Figures that measure errors themselves."""


def judged_by(subject: Subject, equations: Equations, *, by_itself: bool = True) -> Judged:
    """Return what a run is judged by: its key figures and the channels they are made from.

    Where a summary says nothing of the motion, the channels of the coordinates are added.
    ``by_itself`` is False for a case among many.
    """
    known = [channel.name for channel in equations.channels]
    names = subject.channels(equations)
    units = {channel.name: channel.unit for channel in equations.channels}
    judgeable = {known[k] for k in watched_channels(equations)}
    if not judgeable.intersection(names):
        coordinates = {state.name for state in equations.states}
        names = [*names, *(n for n in known if n in coordinates and n not in names)]
    numbers = [known.index(name) for name in names]

    def figures(times: Vector, values: Vector) -> dict[str, tuple[float, str]]:
        columns = {name: values[:, k] for k, name in enumerate(names)}
        recording = Recording(times, columns, {name: units[name] for name in names})
        found = {
            entry.name: (float(entry.value), entry.unit)
            for entry in subject.summarise(recording)
            if isinstance(entry.value, Real)
            and not isinstance(entry.value, bool | np.bool_)
            and entry.name not in _OF_CHECKS
        }
        return found

    return Judged(numbers, figures, by_itself)
