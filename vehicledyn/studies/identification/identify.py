"""Parameters and start values of scenarios from measured channels."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.identify import Estimate, estimate
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.base.argument_names import argument
from vehicledyn.base.step_memory import Memory, Shelf
from vehicledyn.base.units import digits_of, shown
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.identification_table import IdentificationTable
from vehicledyn.studies.failed_runs import failure_notes, known_runs
from vehicledyn.studies.identification.experiments import (
    Experiment,
    Fitting,
    MeasuredChannel,
    SampleFit,
    check_measured,
)
from vehicledyn.studies.identification.figure_fitting import FigureFitting
from vehicledyn.studies.identification.identified import Unknowns
from vehicledyn.studies.identification.measured_data import words_on_gaps
from vehicledyn.studies.identification.measured_figures import given_figures, known_names
from vehicledyn.studies.identification.residual_notes import notes_on_noise, notes_on_priors
from vehicledyn.studies.known_names import KnownNames
from vehicledyn.studies.mistakes import Mistakes

Floats = NDArray[np.float64]
AnyFitting: TypeAlias = Fitting | FigureFitting

_WHITE, _SMALL = 4.0, 0.01
"""Largest autocorrelation of white residuals in their errors, and the variance, in that of the
noise, of residuals too small to matter."""


@dataclass(frozen=True)
class IdentificationReport:
    """Identified parameters: names, units and the estimate in SI.

    ``held_out`` are experiments that were not fitted, with the root mean square of their residuals
    in deviations of the noise.
    """

    title: str
    names: list[str]
    units: list[str]
    found: Estimate
    table: IdentificationTable
    held_out: list[tuple[str, float]] = field(default_factory=list)
    n_known: int = 0
    """Runs that were known from before, which the result does not depend on."""

    @property
    def messages(self) -> tuple[str, ...]:
        """Remarks."""
        return self.table.notes

    def as_text(self) -> str:
        """Return values with intervals, and what the data cannot tell."""
        found = self.found
        lines = [f"{self.title}: identified in {found.n_runs} runs"]
        for k, (name, unit) in enumerate(zip(self.names, self.units, strict=True)):
            digits = digits_of(float(found.values[k]), float(np.ptp(found.intervals[k])))
            low, high = (shown(float(v), unit, digits) for v in found.intervals[k])
            value = shown(float(found.values[k]), unit, digits)
            lines.append(f"  {name} = {value}  (95 %: {low} to {high})")
        lines.append(f"residuals: {np.sqrt(found.data_variance):.3g} of the noise given")
        return "\n".join([*lines, *self.table.notes, *known_runs(self.n_known)])

    def as_dict(self) -> dict[str, Any]:
        """Return everything as plain data, in SI; null for an interval without ends."""
        found = self.found
        ends = np.where(np.isfinite(found.intervals), found.intervals, np.nan)
        return {
            "title": self.title,
            "runs": found.n_runs,
            "parameters": {
                name: {
                    "value": float(found.values[k]),
                    "unit": unit,
                    "interval": [None if np.isnan(end) else float(end) for end in ends[k]],
                }
                for k, (name, unit) in enumerate(zip(self.names, self.units, strict=True))
            },
            "set": {
                f"parameters.{name}": f"{float(found.values[k])!r} {unit}".removesuffix(" 1")
                for k, (name, unit) in enumerate(zip(self.names, self.units, strict=True))
                if not name.startswith("start.")
            },
            "covariance": found.covariance.tolist(),
            "residuals": float(np.sqrt(found.data_variance)),
            "held_out": dict(self.held_out),
            "notes": list(self.table.notes),
        }


def identify(
    loaded: LoadedScenario,
    measured: Sequence[MeasuredChannel],
    parameters: Mapping[str, Mapping[str, Any]],
    progress: Progress,
    figures: Mapping[str, Mapping[str, Any]] = MappingProxyType({}),
) -> IdentificationReport:
    """Return the parameters with which one scenario comes closest to measurements.

    The arguments are those of :func:`identify_from`, of one experiment; ``figures`` those of
    :func:`given_figures`.
    """
    found = [item.without_gaps() for item in measured]
    notes = [f"{item.channel}: {words_on_gaps(lost)}" for item, lost in found if lost]
    mistakes = Mistakes()
    groups, lost = given_figures(mistakes, loaded, figures, progress)
    known = known_names(loaded, groups, is_run=bool(measured), progress=progress)
    experiments = [Experiment("", loaded, tuple(item for item, _ in found), groups)]
    own = [(loaded, known)]
    unknowns = checked_unknowns(mistakes, experiments, parameters, (), own)
    mistakes.refuse()
    return identify_from(
        loaded.title,
        experiments,
        parameters,
        progress=progress,
        remarks=[*notes, *lost],
        unknowns=unknowns,
    )


def identify_from(
    title: str,
    experiments: Sequence[Experiment],
    parameters: Mapping[str, Mapping[str, Any]],
    *,
    progress: Progress,
    held_out: Sequence[str] = (),
    runs: Memory | None = None,
    remarks: Sequence[str] = (),
    unknowns: Unknowns | None = None,
    most_runs: int | None = None,
) -> IdentificationReport:
    """Return the parameters with which scenarios come closest to measurements of all experiments.

    Parameters
    ----------
    title
        What the report is called.
    experiments
        Scenarios with their measurements.
    parameters
        For each parameter, or start value ``start.STATE``, ``from`` and ``to``, further ``start``,
        and ``prior`` with its ``deviation`` for what is known beforehand.
    progress
        Called with what is going on.
    held_out
        Names of experiments that are not fitted but show how well the others foretell them.
    runs
        Runs that are known, to which further ones are added.
    remarks
        Notes on the measurements that the report repeats.
    unknowns
        The parameters as they were read, where all of it was checked.
    most_runs
        Runs of each experiment after which the search ends; None for a hundred a parameter.

    Raises
    ------
    InputError
        If a name, a bound or a measurement cannot be used.
    NumericalError
        If a run fails.
    """
    if unknowns is None:
        mistakes = Mistakes()
        known = [(item.loaded, KnownNames.of(item.loaded, progress)) for item in experiments]
        unknowns = checked_unknowns(mistakes, experiments, parameters, held_out, known)
        mistakes.refuse()
    runs = runs or Memory(Shelf())
    fittings = [part for item in experiments for part in _fittings(item, runs, progress)]
    chosen = [item for item in fittings if item.experiment.name not in held_out]

    def residuals(point: Floats) -> tuple[Floats, Floats]:
        parts = [item.residuals(unknowns, point) for item in chosen]
        parts.append(unknowns.prior_residuals(point))
        return np.concatenate([part[0] for part in parts]), np.vstack([part[1] for part in parts])

    bounds = unknowns.low, unknowns.high
    n_known = int(np.isfinite(unknowns.prior).sum())
    found = estimate(
        residuals, start=unknowns.start, bounds=bounds, most_runs=most_runs, n_known=n_known
    )
    others: dict[str, list[Floats]] = {}
    for item in fittings:
        if (name := item.experiment.name) in held_out:
            others.setdefault(name, []).append(item.residuals(unknowns, found.values)[0])
    foretold = [(name, _root_mean_square(np.concatenate(parts))) for name, parts in others.items()]
    notes = [
        f"held out: {name}, residuals {size:.3g} of the noise given" for name, size in foretold
    ]
    fits = [
        (f"{item.experiment.name}/{fit.about.name}".removeprefix("/"), fit)
        for item in chosen
        for fit in item.fits(unknowns, found.values)
    ]
    notes += [*remarks, *_notes(unknowns, found, chosen, fits)]
    table = _table(title, unknowns, found, fits, notes)
    return IdentificationReport(
        title, unknowns.names, unknowns.units, found, table, foretold, n_known=runs.n_known
    )


def _fittings(experiment: Experiment, runs: Memory, progress: Progress) -> Iterator[AnyFitting]:
    """Yield what fits the signals of an experiment, and each group of its figures."""
    if experiment.measured:
        yield Fitting.of(experiment, runs, progress)
    for number, group in enumerate(experiment.figures):
        yield FigureFitting(experiment, number, group, runs, progress)


def checked_unknowns(
    mistakes: Mistakes,
    experiments: Sequence[Experiment],
    parameters: Mapping[str, Any],
    held_out: Sequence[str],
    known: Sequence[tuple[LoadedScenario, KnownNames]],
) -> Unknowns:
    """Return what is sought; what is wrong with it and with the measurements is noted.

    ``known`` are the scenarios and what their names mean, the other arguments those of
    :func:`identify_from`.
    """
    for item in experiments:
        check_measured(mistakes, item)
    unknowns = Unknowns.of(mistakes, parameters, known)
    fitted = [item for item in experiments if item.name not in held_out]
    count = sum(item.n_samples for item in fitted)
    if experiments and not fitted:
        mistakes.wrong(("hold_out",), "all experiments are held out; leave one or more to fit")
    elif not mistakes.problems and count <= len(parameters):
        words = f"{len(parameters)} parameters need more samples than that; there are {count}"
        mistakes.wrong(("parameters",), words, at_key=True)
    return unknowns


def _root_mean_square(values: Floats) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _table(
    title: str,
    unknowns: Unknowns,
    found: Estimate,
    fits: Sequence[tuple[str, SampleFit]],
    notes: Sequence[str],
) -> IdentificationTable:
    """Return the result with the fit of every sample."""
    signals: list[Quantity] = []
    over: list[str] = []
    rows: list[Floats] = []
    for name, fit in fits:
        which = np.full(len(fit.places), float(len(signals)))
        signals.append(replace(fit.about, name=name))
        over.append(fit.over)
        rows.append(np.stack([which, *fit[2:]]))
    number, time, measured, fitted, residual = np.hstack(rows)
    return IdentificationTable(
        title,
        found.message,
        found.n_runs,
        unknowns.quantities,
        unknowns.start,
        found.values,
        found.intervals[:, 0],
        found.intervals[:, 1],
        found.covariance,
        found.data_variance,
        found.whiteness,
        tuple(signals),
        number,
        time,
        measured,
        fitted,
        residual,
        tuple(notes),
        tuple(over),
    )


def _notes(
    unknowns: Unknowns,
    found: Estimate,
    fittings: list[AnyFitting],
    fits: Sequence[tuple[str, SampleFit]],
) -> list[str]:
    """Return what a reader of the result must know of it."""
    names = unknowns.names
    notes = failure_notes(found.failures)
    if found.message != "converged":
        more = f"; allow more (most_runs) and go on with {argument('resume')}"
        words = f"{found.message}{more if found.was_stopped else ''}"
        notes.append(f"warning: the search has not converged: {words}")
    for row in found.blind:
        parts = [f"{row[k]:+.2g} {names[k]}" for k in np.flatnonzero(np.abs(row) > 1e-3)]
        notes.append(f"the data cannot tell {' '.join(parts)}, each as a part of its range")
    if found.whiteness > _WHITE and found.data_variance > _SMALL:
        notes.append("warning: residuals are not white; the model misses something")
    notes += [*notes_on_noise(fits, found), *notes_on_priors(unknowns, found)]
    for k in unknowns.at_bound(found.values):
        notes.append(f"warning: '{names[k]}' lies at its bound; its interval means little")
    for item in fittings:
        notes += item.warnings_at(unknowns, found.values)
    return list(dict.fromkeys(notes))
