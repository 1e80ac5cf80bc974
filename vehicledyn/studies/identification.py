"""Parameters of a scenario from measured channels."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.identify import Estimate, estimate
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.motion_study import MotionStudy
from vehicledyn.analyses.sensitivity.names import directions
from vehicledyn.analyses.simulation.prepared_run import prepare_run
from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.base.units import shown, to_si
from vehicledyn.files.scenario import LoadedScenario

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Measured:
    """A measured channel: times (m,) [s], values (m,) in SI and the deviation of their noise."""

    channel: str
    times: Floats
    values: Floats
    noise: float


@dataclass(frozen=True)
class IdentificationReport:
    """Identified parameters: names, units and the estimate in SI."""

    title: str
    names: list[str]
    units: list[str]
    found: Estimate

    def as_text(self) -> str:
        """Return values with intervals, and what the data cannot tell."""
        found = self.found
        lines = [f"{self.title}: identified in {found.n_runs} runs"]
        for k, (name, unit) in enumerate(zip(self.names, self.units, strict=True)):
            low, high = (shown(float(v), unit) for v in found.intervals[k])
            value = shown(float(found.values[k]), unit)
            lines.append(f"  {name} = {value}  (95 %: {low} to {high})")
        lines.append(f"residuals: {np.sqrt(found.variance):.3g} of the noise given")
        for row in found.blind:
            parts = [f"{row[k]:+.2g} {self.names[k]}" for k in np.flatnonzero(np.abs(row) > 1e-3)]
            lines.append(f"the data cannot tell {' '.join(parts)}, each as a part of its range")
        if found.whiteness > 4.0:
            lines.append("warning: residuals are not white; the model misses something")
        return "\n".join(lines)


def identify(
    loaded: LoadedScenario,
    measured: Sequence[Measured],
    parameters: Mapping[str, Mapping[str, Any]],
    progress: Progress,
) -> IdentificationReport:
    """Return the parameters with which a scenario comes closest to measurements.

    Parameters
    ----------
    loaded
        The scenario; its samples are interpolated to the times of the measurements.
    measured
        The measurements.
    parameters
        For each parameter ``from`` and ``to``.
    progress
        Called with what is going on.

    Raises
    ------
    InputError
        If a name, a bound or a measurement cannot be used.
    NumericalError
        If a run fails.
    """
    for item in measured:
        _check(item, loaded.scenario.duration)
    channels = list(dict.fromkeys(item.channel for item in measured))
    study = MotionStudy.of(loaded, channels, progress)
    e = study.prepared.equations
    units = {p.name: p.unit for p in e.parameters}
    names = [name.removeprefix("parameters.") for name in parameters]
    for name in names:
        if name not in units or name == "speed":
            guess = nearest_name(name, units)
            hint = f"; did you mean '{guess}'?" if guess else ""
            raise InputError(f"'{name}' is no parameter of '{e.name}' to identify{hint}")
    if sum(len(item.times) for item in measured) <= len(names):
        raise InputError(f"{len(names)} parameters need more samples than that")
    low, high = (
        np.array(
            [to_si(v[side], units[n]) for n, v in zip(names, parameters.values(), strict=True)]
        )
        for side in ("from", "to")
    )
    for name, first, last in zip(names, low, high, strict=True):
        if not first < last:
            raise InputError(f"parameters.{name}: from must be below to")
    start = study.prepared.kernel.parameters[[list(units).index(name) for name in names]]
    places = {e.channels[k].name: place for place, k in enumerate(study.channels)}

    def residuals(point: Floats) -> tuple[Floats, Floats]:
        own = study.moved(dict(zip(names, map(float, point), strict=True)))
        chosen = directions(e, own.prepared.kernel.parameters, own.start.state, names)
        motion = own.followed(chosen, progress)
        missed, slopes = [], []
        for item in measured:
            place = places[item.channel]
            values = np.interp(item.times, motion.times, motion.values[:, place])
            missed.append((values - item.values) / item.noise)
            columns = [
                np.interp(item.times, motion.times, motion.slopes[:, place, k]) / item.noise
                for k in range(len(names))
            ]
            slopes.append(np.stack(columns, axis=1))
        return np.concatenate(missed), np.vstack(slopes)

    found = estimate(residuals, start=np.clip(start, low, high), bounds=(low, high))
    return IdentificationReport(loaded.title, names, [units[name] for name in names], found)


def channel_unit(loaded: LoadedScenario, channel: str) -> str:
    """Return the unit of a channel.

    Raises
    ------
    InputError
        If there is none of this name.
    """
    prepared, _ = prepare_run(loaded, backend="auto", progress=lambda *_: None)
    units = {item.name: item.unit for item in prepared.equations.channels}
    if channel not in units:
        guess = nearest_name(channel, units)
        hint = f"; did you mean '{guess}'?" if guess else ""
        raise InputError(f"'{channel}' is no channel of '{prepared.equations.name}'{hint}")
    return units[channel]


def _check(item: Measured, duration: float) -> None:
    """Raise InputError for a measurement that cannot be used."""
    where = f"measured '{item.channel}'"
    if item.times.shape != item.values.shape or item.times.ndim != 1 or not item.times.size:
        raise InputError(f"{where}: needs as many values as times")
    if not (np.isfinite(item.times).all() and np.isfinite(item.values).all()):
        raise InputError(f"{where}: has gaps; leave the samples without a value out")
    if np.any(np.diff(item.times) <= 0.0):
        raise InputError(f"{where}: its times must grow")
    if item.times[0] < 0.0 or item.times[-1] > duration * (1.0 + 1e-12):
        raise InputError(f"{where}: lies outside the run from 0 to {duration:g} s")
    if not item.noise > 0.0:
        raise InputError(f"{where}: the deviation of its noise must be above zero")
