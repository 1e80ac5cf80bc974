"""Identification studies as files: experiments with their data, parameters, what is held out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.preparation.target_digest import digests_to_keep
from vehicledyn.base.errors import InputError, errors_of, nearest_name
from vehicledyn.base.files.limits import UnreadableFileError, check_regular
from vehicledyn.base.problems import Place
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.studies.identification.experiments import (
    Experiment,
    MeasuredChannel,
)
from vehicledyn.studies.identification.identified import Unknowns
from vehicledyn.studies.identification.identify import (
    IdentificationReport,
    checked_unknowns,
    identify_from,
)
from vehicledyn.studies.identification.low_pass import MOST_ORDER, LowPass
from vehicledyn.studies.identification.measured_data import (
    MeasuredSignal,
    read_signals,
    words_on_gaps,
)
from vehicledyn.studies.identification.measured_figures import known_names, read_figures
from vehicledyn.studies.known_names import KnownNames
from vehicledyn.studies.mistakes import silent
from vehicledyn.studies.study_form import StudyForm

Floats = NDArray[np.float64]

_REQUIRED = ("experiments", "parameters")
_OPTIONAL = ("title", "hold_out", "most_runs")
_EXPERIMENT = ("scenario", "set", "data", "time", "time_unit", "signals", "figures")
_SIGNAL = ("column", "unit", "noise", "lag", "low_pass", "order")


@dataclass(frozen=True)
class IdentificationStudy:
    """Experiments and unknown parameters; ``texts`` tell this study from others."""

    title: str
    experiments: list[Experiment]
    parameters: dict[str, Any]
    unknowns: Unknowns
    held_out: list[str]
    most_runs: int | None
    notes: list[str]
    texts: list[str]

    def subjects(self) -> list[LoadedScenario]:
        """Return the scenarios of its experiments."""
        return [experiment.loaded for experiment in self.experiments]


def run_identification_study(
    path: Path,
    overrides: Sequence[str],
    *,
    kept: KeptWork,
    progress: Progress,
) -> IdentificationReport:
    """Return what a study file asks for.

    Parameters
    ----------
    path
        YAML file.
    overrides
        Changes ``key=value`` of all scenarios.
    kept
        What is kept while it is computed.
    progress
        Called with what is going on.

    Raises
    ------
    InputError
        If anything in the study or its data is wrong; all problems of its form are listed.
    NumericalError
        If a run fails at the start.
    """
    study = load_identification(path, overrides, progress)
    scenarios = digests_to_keep(kept, [item.loaded for item in study.experiments])
    runs = kept.memory("identify", study.texts, scenarios, asked_again=True)
    with errors_of(path):
        return identify_from(
            study.title,
            study.experiments,
            study.parameters,
            progress=progress,
            held_out=study.held_out,
            runs=runs,
            remarks=study.notes,
            unknowns=study.unknowns,
            most_runs=study.most_runs,
        )


def load_identification(
    path: Path, overrides: Sequence[str] = (), progress: Progress = silent
) -> IdentificationStudy:
    """Read a study file and its data, and check it against its scenarios.

    Raises
    ------
    InputError
        If anything in the study or its data is wrong; all problems are listed.
    """
    form = StudyForm.read(path, required=_REQUIRED, optional=_OPTIONAL)
    given = dict(form.entries(("experiments",), _EXPERIMENT, ("scenario",)))
    parameters = dict(form.entries(("parameters",), needed=("from", "to")))
    held_out = _held_out(form, given)
    most_runs = None
    if "most_runs" in form.data:
        most_runs = int(form.number("most_runs", 1, least=1, whole=True))
    experiments, texts, notes = [], [form.identity("most_runs")], list[str]()
    known = []
    for name, item in given.items():
        where: Place = ("experiments", name)
        loaded = form.scenario(
            (*where, "scenario"),
            item["scenario"],
            item.get("set"),
            overrides,
            groups=[(*where, "set")],
        )
        if loaded is None:
            continue
        data = _data(form, where, item)
        with form.mistakes.at(*where, "scenario"):
            figures, lost = read_figures(form, where, loaded, data, progress)
            notes += lost
            is_run = bool(item.get("signals"))
            own = known_names(loaded, figures, is_run=is_run, progress=progress)
            measured, lost = _measured(form, where, item, data, own)
            notes += lost
            known.append((loaded, own))
            experiments.append(Experiment(name, loaded, measured, figures))
            texts += [loaded.text, repr(loaded.overrides)]
            texts.append(repr([m.values.tobytes() for m in measured]))
            measurements = [m for group in figures for m in group.items]
            texts.append(repr([(m.figures, m.values.tobytes()) for m in measurements]))
    unknowns = None
    if known:
        unknowns = checked_unknowns(form.mistakes, experiments, parameters, held_out, known)
    form.refuse()
    assert unknowns is not None  # without any experiment the study was refused
    title = str(form.data.get("title", path.stem))
    return IdentificationStudy(
        title, experiments, parameters, unknowns, held_out, most_runs, notes, texts
    )


def _held_out(form: StudyForm, known: dict[str, Any]) -> list[str]:
    names = form.data.get("hold_out") or []
    if not isinstance(names, list):
        form.wrong(("hold_out",), "expected a list of experiments")
        return []
    for k, name in enumerate(names):
        if not isinstance(name, str) or name not in known:
            guess = nearest_name(str(name), known)
            hint = f"; did you mean '{guess}'?" if guess else ""
            form.wrong(("hold_out", k), f"'{name}' is no experiment{hint}")
    return [str(name) for name in names]


def _data(form: StudyForm, where: Place, item: dict[str, Any]) -> Path | None:
    """Return the file of an experiment's data, None if it has none; what is wrong is noted."""
    if not (item.get("signals") or item.get("figures")):
        form.wrong(where, "needs signals, figures or both")
    if "data" not in item:
        if item.get("signals"):
            form.wrong(where, "needs data")
        return None
    data = form.path.parent / str(item["data"])
    try:
        check_regular(data)
    except UnreadableFileError as error:
        form.wrong((*where, "data"), f"'{item['data']}' in the folder of the study: {error.words}")
        return None
    return data


def _measured(
    form: StudyForm, where: Place, item: dict[str, Any], data: Path | None, known: KnownNames
) -> tuple[tuple[MeasuredChannel, ...], list[str]]:
    """Return the measured channels of an experiment, and remarks on their gaps.

    What is wrong with them is noted.
    """
    signals, filters = [], dict[str, LowPass | None]()
    for channel, entry in form.entries((*where, "signals"), _SIGNAL, ("noise",)):
        place: Place = (*where, "signals", channel)
        count = len(form.mistakes.problems)
        with form.mistakes.at(*place):
            unit = known.channel_unit(channel)
            noise = form.mistakes.number((*place, "noise"), entry["noise"], unit)
            lag = form.mistakes.number((*place, "lag"), entry.get("lag", "0 s"), "s")
            filters[channel] = _low_pass(form, place, entry)
            column = str(entry.get("column", channel))
            if count == len(form.mistakes.problems):
                given_unit = entry.get("unit")
                signals.append(MeasuredSignal(channel, column, unit, given_unit, noise, lag))
    if data is None or not signals:
        return (), []
    time = str(item.get("time", "time")), item.get("time_unit")
    measured, notes = [], []
    for signal, columns in _read(form, where, data, time, signals):
        found = MeasuredChannel(
            signal.channel, *columns, signal.noise, signal.lag, filters[signal.channel]
        )
        kept, lost = found.without_gaps()
        measured.append(kept)
        if lost:
            notes.append(f"{data.name}: {signal.column}: {words_on_gaps(lost)}")
    return tuple(measured), notes


def _low_pass(form: StudyForm, place: Place, entry: dict[str, Any]) -> LowPass | None:
    """Return the filter of a signal, None if it has none; what is wrong with it is noted."""
    if "low_pass" not in entry:
        if "order" in entry:
            form.wrong((*place, "order"), "is that of a filter; give its low_pass too")
        return None
    frequency = form.mistakes.number((*place, "low_pass"), entry["low_pass"], "Hz")
    order = entry.get("order", 2)
    if frequency <= 0.0:
        form.wrong((*place, "low_pass"), "the corner frequency must be above zero")
    if isinstance(order, bool) or not isinstance(order, int) or not 1 <= order <= MOST_ORDER:
        form.wrong((*place, "order"), f"expected a whole number from 1 to {MOST_ORDER}")
        return None
    return LowPass(frequency, order)


def _read(
    form: StudyForm,
    where: Place,
    data: Path,
    time: tuple[str, str | None],
    signals: Sequence[MeasuredSignal],
) -> list[tuple[MeasuredSignal, tuple[Floats, Floats]]]:
    """Return signals with their times and values; nothing, and problems, where one is wrong."""
    try:
        return list(zip(signals, read_signals(data, time[0], signals, time[1]), strict=True))
    except InputError:
        pass
    for signal in signals:
        try:
            read_signals(data, time[0], [signal], time[1])
        except InputError as error:
            is_own = signal.column in error.about
            place = (*where, "signals", signal.channel) if is_own else (*where, "data")
            with form.mistakes.at(*place):
                raise
    return []
