"""Identification studies as files: experiments with their data, parameters, what is held out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.preparation.target_digest import digests_to_keep
from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.base.files.limits import UnreadableFileError, check_regular
from vehicledyn.base.units import to_si
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.studies.identification.experiments import Experiment, Measured
from vehicledyn.studies.identification.identified import KEYS
from vehicledyn.studies.identification.identify import (
    IdentificationReport,
    channel_unit,
    identify_from,
)
from vehicledyn.studies.identification.measured_data import Signal, read_signals
from vehicledyn.studies.study_form import StudyForm

_REQUIRED = ("experiments", "parameters")
_OPTIONAL = ("title", "hold_out")
_EXPERIMENT = ("scenario", "set", "data", "time", "signals")
_SIGNAL = ("column", "unit", "noise", "lag")


@dataclass(frozen=True)
class IdentificationStudy:
    """Experiments and unknown parameters; ``texts`` tell this study from others."""

    title: str
    experiments: list[Experiment]
    parameters: dict[str, Any]
    held_out: list[str]
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
    study = load_identification(path, overrides)
    scenarios = digests_to_keep(kept, [item.loaded for item in study.experiments])
    runs = kept.memory("identify", study.texts, scenarios, asked_again=True)
    try:
        return identify_from(
            study.title,
            study.experiments,
            study.parameters,
            progress=progress,
            held_out=study.held_out,
            runs=runs,
            remarks=study.notes,
        )
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def load_identification(path: Path, overrides: Sequence[str] = ()) -> IdentificationStudy:
    """Read and check a study file, its scenarios and its data.

    Raises
    ------
    InputError
        If anything in the study or its data is wrong; all problems of its form are listed.
    """
    form = StudyForm.read(path, required=_REQUIRED, optional=_OPTIONAL)
    given = dict(form.entries(("experiments",), _EXPERIMENT, ("scenario", "data", "signals")))
    for name in given:
        for _ in form.entries(("experiments", name, "signals"), _SIGNAL, ("noise",)):
            pass
    parameters = dict(form.entries(("parameters",), KEYS, ("from", "to")))
    held_out = _held_out(form, given)
    form.refuse()
    experiments, texts, notes = [], [form.document.text], []
    for name, item in given.items():
        place = ("experiments", name, "scenario")
        loaded = form.scenario(place, item["scenario"], item.get("set"), overrides)
        measured, lost = _measured(path, name, item, loaded)
        experiments.append(Experiment(name, loaded, measured))
        texts += [loaded.text, repr(loaded.overrides), repr([m.values.tobytes() for m in measured])]
        notes += lost
    title = str(form.data.get("title", path.stem))
    return IdentificationStudy(title, experiments, parameters, held_out, notes, texts)


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


def _measured(
    path: Path, name: str, item: dict[str, Any], loaded: LoadedScenario
) -> tuple[tuple[Measured, ...], list[str]]:
    """Return the measured channels of an experiment, and remarks on their gaps."""
    where = f"{path}: experiments.{name}"
    signals = []
    for channel, entry in item["signals"].items():
        try:
            unit = channel_unit(loaded, channel)
            noise = float(to_si(entry["noise"], unit))
            lag = float(to_si(entry.get("lag", "0 s"), "s"))
        except InputError as error:
            raise InputError(f"{where}.signals.{channel}: {error}") from None
        column = str(entry.get("column", channel))
        signals.append(Signal(channel, column, unit, entry.get("unit"), noise, lag))
    data = path.parent / str(item["data"])
    try:
        check_regular(data)
    except UnreadableFileError as error:
        raise InputError(
            f"{where}.data: '{item['data']}' beside the study: {error.words}"
        ) from None
    found, notes = [], []
    for signal, (times, values) in zip(
        signals, read_signals(data, str(item.get("time", "time")), signals), strict=True
    ):
        kept = ~np.isnan(values)
        if not kept.all():
            notes.append(f"{data.name}: {signal.column}: {int((~kept).sum())} gaps are left out")
        channel = signal.channel
        found.append(Measured(channel, times[kept], values[kept], signal.noise, signal.lag))
    return tuple(found), notes
