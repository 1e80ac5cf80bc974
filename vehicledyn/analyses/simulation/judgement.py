"""What the accuracy of a run is judged by: the key figures of what runs."""

from __future__ import annotations

from numbers import Real

import numpy as np

from vehicledyn.analyses.preparation.energy_figures import energy_balance, rough_balance
from vehicledyn.analyses.preparation.runnable import Subject, Vector
from vehicledyn.analyses.preparation.time_jumps import time_jumps
from vehicledyn.integrate.channel_ranges import watched_channels
from vehicledyn.integrate.estimated_accuracy import ENERGY
from vehicledyn.integrate.judged_quantities import EnergyBalance, Judged
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.symbolic.equations import Equations

_OF_CHECKS = (ENERGY, "largest_loop_gap", "largest_loop_speed")
"""Figures that measure errors themselves; that of the energy is judged apart."""


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

    def recorded(times: Vector, values: Vector) -> Recording:
        columns = {name: values[:, k] for k, name in enumerate(names)}
        return Recording(times, columns, {name: units[name] for name in names})

    def balance(times: Vector, values: Vector, *, rough: bool = False) -> EnergyBalance | None:
        recording = recorded(times, values)
        if rough:
            return rough_balance(recording)
        return energy_balance(recording, time_jumps(subject.system, times[0], times[-1]))

    def figures(times: Vector, values: Vector) -> dict[str, tuple[float, str]]:
        recording = recorded(times, values)
        found = {
            entry.name: (float(entry.value), entry.unit)
            for entry in subject.summarise(recording)
            if isinstance(entry.value, Real)
            and not isinstance(entry.value, bool | np.bool_)
            and entry.name not in _OF_CHECKS
        }
        return found

    changed = any(getattr(part, "changes_motion", False) for part in subject.system.parts)
    energy = None if changed else balance
    return Judged(numbers, figures, by_itself, energy, closely=by_itself)
