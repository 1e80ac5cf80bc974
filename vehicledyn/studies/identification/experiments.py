"""Measured experiments, and how far a scenario's run is from them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.confirmation import unconfirmed
from vehicledyn.analyses.sensitivity.driving_failures import driving_failure
from vehicledyn.analyses.sensitivity.motion_study import MotionStudy
from vehicledyn.analyses.sensitivity.names import directions
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.problems import Place
from vehicledyn.base.step_memory import Memory
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.studies.failed_runs import with_values
from vehicledyn.studies.identification.low_pass import LowPass
from vehicledyn.studies.mistakes import Mistakes

if TYPE_CHECKING:
    from vehicledyn.studies.identification.identified import Unknowns
    from vehicledyn.studies.identification.measured_figures import MeasuredFigures

Floats = NDArray[np.float64]

TIME = "time [s]"
"""What signals are measured over."""

_COARSE = 0.1
"""Part of the noise that samples may miss between them without a warning."""

_OTHER_UNIT = 10.0
"""Times its run that a measurement lasts from which on its times may be in another unit."""


@dataclass(frozen=True)
class MeasuredChannel:
    """A measured channel: times (m,) [s], values (m,) in SI and the deviation of their noise.

    ``lag`` [s] is by how much its clock is late: measured at t is what happened at t - lag, behind
    the filter of its sensor if that has one.
    """

    channel: str
    times: Floats
    values: Floats
    noise: float
    lag: float = 0.0
    low_pass: LowPass | None = None

    def without_gaps(self) -> tuple[MeasuredChannel, int]:
        """Return it without samples that have no value, and how many these are."""
        is_gap = np.isnan(self.values)
        if self.times.shape != self.values.shape or not is_gap.any():
            return self, 0
        kept = replace(self, times=self.times[~is_gap], values=self.values[~is_gap])
        return kept, int(is_gap.sum())


@dataclass(frozen=True)
class Experiment:
    """A scenario and what was measured of it: channels, and figures of it."""

    name: str
    loaded: LoadedScenario
    measured: tuple[MeasuredChannel, ...]
    figures: tuple[MeasuredFigures, ...] = ()

    @property
    def n_samples(self) -> int:
        """Number of measured values."""
        count = sum(len(item.times) for item in self.measured)
        return count + sum(len(item.values) for group in self.figures for item in group.items)


class SampleFit(NamedTuple):
    """How a signal or figure was measured and fitted at ``places`` (m,), with its residuals.

    ``over`` says what the places are, and in which unit, such as ``time [s]``.
    """

    about: Quantity
    over: str
    places: Floats
    measured: Floats
    fitted: Floats
    residuals: Floats


@dataclass(frozen=True)
class Fitting:
    """An experiment made ready: its scenario can be followed with derivatives."""

    experiment: Experiment
    study: MotionStudy
    runs: Memory
    progress: Progress

    @staticmethod
    def of(experiment: Experiment, runs: Memory, progress: Progress) -> Fitting:
        """Prepare the scenario of an experiment whose measurements were checked.

        Raises
        ------
        InputError
            If its motion has no derivatives.
        """
        channels = list(dict.fromkeys(item.channel for item in experiment.measured))
        study = MotionStudy.of(experiment.loaded, channels, progress)
        return Fitting(experiment, study, runs, progress)

    def values(self, unknowns: Unknowns, point: Floats) -> tuple[list[Floats], list[Floats]]:
        """Return the model's values at the samples of each signal, and their slopes.

        Raises
        ------
        NumericalError
            If the run fails.
        """
        entry = self._entry(unknowns, point)
        if "failure" in entry:
            raise NumericalError(f"{with_values(unknowns.quantities, point)}: {entry['failure']}")
        times = np.array(entry["times"])
        values, slopes = [], []
        for item in self.experiment.measured:
            at = item.times - item.lag
            own = np.array(entry["values"][item.channel])
            rows = np.array(entry["slopes"][item.channel]).reshape(len(times), len(point))
            if item.low_pass is not None:
                both = item.low_pass.applied(times, np.column_stack([own, rows]))
                own, rows = both[:, 0], both[:, 1:]
            values.append(np.interp(at, times, own))
            columns = [np.interp(at, times, rows[:, k]) for k in range(len(point))]
            slopes.append(np.stack(columns, axis=1))
        return values, slopes

    def residuals(self, unknowns: Unknowns, point: Floats) -> tuple[Floats, Floats]:
        """Return model less measurement in deviations of the noise, and the Jacobian."""
        values, slopes = self.values(unknowns, point)
        signals = self.experiment.measured
        missed = [(own - s.values) / s.noise for own, s in zip(values, signals, strict=True)]
        rows = [slope / s.noise for slope, s in zip(slopes, signals, strict=True)]
        return np.concatenate(missed), np.vstack(rows)

    def fits(self, unknowns: Unknowns, point: Floats) -> list[SampleFit]:
        """Return the fit of every sample, signal by signal."""
        channels = {c.name: c for c in self.study.prepared.equations.channels}
        found = []
        for item, own in zip(
            self.experiment.measured, self.values(unknowns, point)[0], strict=True
        ):
            about = channels[item.channel]
            quantity = Quantity(about.name, about.unit, about.description)
            missed = (own - item.values) / item.noise
            found.append(SampleFit(quantity, TIME, item.times, item.values, own, missed))
        return found

    def warnings_at(self, unknowns: Unknowns, point: Floats) -> list[str]:
        """Return what is to be known of the run at a point."""
        missed, notes = self._missed_between_samples(unknowns, point), []
        if missed > _COARSE:
            notes.append(
                f"warning: straight lines between samples of {self.experiment.loaded.title} miss "
                f"up to {missed:.2g} of the noise; give it a smaller output.interval"
            )
        return [*notes, *self.study.notes, *self._unconfirmed(unknowns, point)]

    def _unconfirmed(self, unknowns: Unknowns, point: Floats) -> list[str]:
        """Return warnings of derivatives that differences of runs do not confirm."""
        own = self.study.moved(dict(zip(unknowns.names, map(float, point), strict=True)))
        e, parameters = own.prepared.equations, own.prepared.kernel.parameters
        chosen = directions(e, parameters, own.start.state, unknowns.names)
        names = [e.channels[k].name for k in own.channels]
        judged = dict.fromkeys(names.index(item.channel) for item in self.experiment.measured)
        return unconfirmed(own, chosen, own.followed(chosen, self.progress), list(judged))

    def _missed_between_samples(self, unknowns: Unknowns, point: Floats) -> float:
        """Return what straight lines between the run's samples miss, in deviations of the noise.

        From what they miss with every other sample, a quarter of which is left with all of them.
        """
        entry = self._entry(unknowns, point)
        times, largest = np.array(entry.get("times", [])), 0.0
        for item in self.experiment.measured:
            at = item.times - item.lag
            near = np.abs(at[:, None] - times[None, :]).min(axis=1, initial=np.inf)
            if len(times) < 3 or np.all(near <= 1e-9 * times[-1]):
                continue
            own = np.array(entry["values"][item.channel])
            coarse = np.interp(times, times[::2], own[::2]) - own
            largest = max(largest, float(np.max(np.abs(coarse))) / (4.0 * item.noise))
        return largest

    def _entry(self, unknowns: Unknowns, point: Floats) -> dict[str, Any]:
        """Return what a run gave."""
        key = self.experiment.name, point
        return self.runs.recall("run", key, lambda: self._run(unknowns, point))

    def _run(self, unknowns: Unknowns, point: Floats) -> dict[str, Any]:
        """Return samples and slopes of a run, or why there are none."""
        try:
            own = self.study.moved(dict(zip(unknowns.names, map(float, point), strict=True)))
            e, parameters = own.prepared.equations, own.prepared.kernel.parameters
            chosen = directions(e, parameters, own.start.state, unknowns.names)
            motion = own.followed(chosen, self.progress)
        except NumericalError as error:
            return {"failure": f"{self.experiment.loaded.title}: {error}"}
        names = [e.channels[k].name for k in self.study.channels]
        wanted = {item.channel for item in self.experiment.measured}
        places = {name: k for k, name in enumerate(names) if name in wanted}
        if lost := driving_failure(own, motion):
            return {"failure": f"{self.experiment.loaded.title}: {lost}"}
        if motion.ended_by:
            words = f"event '{motion.ended_by}' ended the run at {motion.times[-1]:g} s"
            return {"failure": f"{self.experiment.loaded.title}: {words}, before its data end"}
        return {
            "times": motion.times.tolist(),
            "values": {name: motion.values[:, k].tolist() for name, k in places.items()},
            "slopes": {name: motion.slopes[:, k].ravel().tolist() for name, k in places.items()},
        }


def check_measured(mistakes: Mistakes, experiment: Experiment) -> None:
    """Note measurements of an experiment that cannot be used."""
    duration = experiment.loaded.scenario.duration
    for item in experiment.measured:
        place: Place = ("measured", item.channel)
        if experiment.name:
            place = ("experiments", experiment.name, "signals", item.channel)
        if words := _unusable(item, duration, is_study=bool(experiment.name)):
            mistakes.wrong(place, words, at_key=True)


def _unusable(item: MeasuredChannel, duration: float, *, is_study: bool) -> str:
    """Return why a measurement cannot be used, empty if it can."""
    if item.times.shape != item.values.shape or item.times.ndim != 1 or not item.times.size:
        return "needs as many values as times, one or more that are no gaps"
    if not (np.isfinite(item.times).all() and np.isfinite(item.values).all()):
        return "has times or values that are not finite; leave these samples out"
    if np.any(np.diff(item.times) <= 0.0):
        before = float(item.times[int(np.argmax(np.diff(item.times) <= 0.0))])
        return f"its times must grow; the one after {before:g} s does not"
    if words := _beyond(item.times - item.lag, duration, is_study=is_study):
        return words
    if not item.noise > 0.0:
        return "the deviation of its noise must be above zero"
    return ""


def _beyond(at: Floats, duration: float, *, is_study: bool) -> str:
    """Return words on times that lie outside a run, empty if they lie inside."""
    if at[0] >= 0.0 and at[-1] <= duration * (1.0 + 1e-12):
        return ""
    change = "'duration' or 'lag'" if is_study else "'duration'"
    words = (
        f"its times from {at[0]:g} to {at[-1]:g} s lie outside the run from 0 to "
        f"{duration:g} s; leave the samples beyond out, or change {change}"
    )
    if at[-1] - at[0] < _OTHER_UNIT * duration:
        return words
    unit = "give the unit that they have as 'time_unit'" if is_study else "convert them"
    return f"{words}; if they are not in seconds, {unit}"
