"""Report wheels that stand and whose laws hold for rolling: all on rails, some on the road."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.prepare import AssembledPoint
from vehicledyn.analyses.preparation.prepared import Prepared

_SLOW = 0.1
"""Speed along the track below which a wheel counts as standing [m/s]."""
_SPEED = ".track_speed"

_LOAD, _DEFLECTION = ".tyre.normal_force", ".tyre.longitudinal_deflection"
_SPIN = ".spin_rate"
_PLACE = ".contact_x", ".contact_y"

_LAST = 0.5
"""Time at the end of a run in which locked wheels are looked at [s]."""
_CREEP = 1e-4, 0.1
"""Speeds between which a locked wheel creeps: it neither stands nor slides to its stop [m/s]."""
_LOCKED = 0.5
"""Spin over speed below which a wheel does not roll [rad/m]; wheels of 2 m radius roll with it."""

Floats = NDArray[np.float64]


def standing_wheels(prepared: Prepared, start: AssembledPoint) -> list[str]:
    """Return a line about wheels that stand at the start of a run, on rails or on the road."""
    names = [channel.name for channel in prepared.equations.channels]
    if not any(name.endswith((_SPEED, _LOAD)) for name in names):
        return []
    outputs = prepared.kernel.outputs(0.0, start.state, start.unknowns)
    values = dict(zip(names, map(float, outputs), strict=True))
    return [*_on_rails(values), *_on_the_road(values, {s.name for s in prepared.equations.states})]


def _on_rails(values: Mapping[str, float]) -> list[str]:
    found = [
        name.removesuffix(_SPEED)
        for name, value in values.items()
        if name.endswith(_SPEED) and abs(value) < _SLOW
    ]
    if not found:
        return []
    return [
        f"wheels on rails stand at the start: {', '.join(found)}; creep forces are those of "
        f"rolling wheels, below {_SLOW:g} m/s they are stiff and chatter in fixed steps: give a "
        "speed, or use an implicit solver and keep to the vertical motion"
    ]


def _on_the_road(values: Mapping[str, float], states: Collection[str]) -> list[str]:
    """Return the line about wheels whose tyres resist only while they slide."""
    wheels = [name.removesuffix(_LOAD) for name in values if name.endswith(_LOAD)]
    found = [
        wheel
        for wheel in wheels
        if values.get(f"{wheel}{_SPIN}") == 0.0 and f"{wheel}{_DEFLECTION}" not in states
    ]
    if not found:
        return []
    return [
        f"wheels stand at the start: {', '.join(found)}; without 'relaxation' a tyre resists only "
        "while it slides, so that locked wheels creep on slopes, whatever the step: give "
        "'relaxation' for a vehicle that is to stand"
    ]


@dataclass
class CreepingWheels:
    """Watches locked wheels on the road at the end of a run, whose tyres cannot hold them.

    ``columns`` are those of the contact point, spin rate and load of each wheel among the
    channels, (n_wheels, 4); ``recent`` are time and these channels in the last moments.
    """

    names: Sequence[str]
    columns: NDArray[np.intp]
    recent: tuple[Floats, Floats] = (np.zeros(0), np.zeros((0, 0, 4)))

    @staticmethod
    def of(prepared: Prepared) -> CreepingWheels:
        """Return a watch on the wheels of a system whose tyres have no deflection as a state."""
        channels = {channel.name: k for k, channel in enumerate(prepared.equations.channels)}
        states = {state.name for state in prepared.equations.states}
        ends = (*_PLACE, _SPIN, _LOAD)
        wheels = [name.removesuffix(_LOAD) for name in channels if name.endswith(_LOAD)]
        names = [
            wheel
            for wheel in wheels
            if f"{wheel}{_DEFLECTION}" not in states and all(wheel + e in channels for e in ends)
        ]
        columns = [[channels[name + end] for end in ends] for name in names]
        return CreepingWheels(names, np.array(columns, dtype=np.intp).reshape(-1, len(ends)))

    def take(self, times: Floats, outputs: Floats) -> None:
        """Take samples of all channels, (n,) and (n, n_channels)."""
        if not self.names:
            return
        before, known = self.recent
        kept = before >= times[-1] - _LAST
        new = times >= times[-1] - _LAST
        values = outputs[new][:, self.columns]
        self.recent = (
            np.concatenate([before[kept], times[new]]),
            np.concatenate([known[kept], values]) if kept.any() else values,
        )

    def remarks(self) -> list[str]:
        """Return a line about wheels that creep at the end though they hardly turn."""
        times, values = self.recent
        if len(times) < 2 or times[-1] - times[0] < 0.8 * _LAST:
            return []
        speeds = np.hypot(*(values[-1] - values[0])[:, :2].T) / (times[-1] - times[0])
        spin, load = np.abs(values[:, :, 2]).max(axis=0), values[:, :, 3].min(axis=0)
        creeps = (speeds > _CREEP[0]) & (speeds < _CREEP[1]) & (spin < _LOCKED * speeds)
        found = [
            name for name, is_so in zip(self.names, creeps & (load > 0.0), strict=True) if is_so
        ]
        if not found:
            return []
        return [
            f"warning: locked wheels creep at {1e3 * speeds[creeps].max():.2g} mm/s at the end: "
            f"{', '.join(found)}; without 'relaxation' a tyre resists only while it slides, "
            "whatever the step: give 'relaxation' for a vehicle that comes to rest"
        ]
