"""Uncertainty studies as files: distributions of parameters, figures, method, limits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.preparation.target_digest import digests_to_keep
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.results.hdf5.kept_work import KeptWork
from vehicledyn.results.tables.uncertainty_table import UncertaintyTable
from vehicledyn.studies.mistakes import silent
from vehicledyn.studies.study_form import StudyForm
from vehicledyn.studies.uncertainty.checks import MOST_RUNS, check_method, note_mistakes
from vehicledyn.studies.uncertainty.report import UncertaintyReport, risk_words
from vehicledyn.studies.uncertainty.run import METHODS, find_uncertainty

_REQUIRED = ("scenario", "of", "parameters")
_OPTIONAL = ("title", "set", "method", "number", "seed", "limits")


@dataclass(frozen=True)
class UncertaintyStudy:
    """A scenario, its figures and scattering parameters.

    ``texts`` distinguish this study from others, ``form`` is the file it was read from.
    """

    title: str
    loaded: LoadedScenario
    of: list[str]
    parameters: dict[str, Any]
    method: str
    number: int
    seed: int
    limits: dict[str, Any]
    texts: tuple[str, ...]
    form: StudyForm

    def subjects(self) -> list[LoadedScenario]:
        """Return its scenario."""
        return [self.loaded]


def run_uncertainty_study(
    path: Path,
    overrides: Sequence[str],
    *,
    kept: KeptWork,
    progress: Progress,
) -> UncertaintyReport:
    """Return what a study file asks for.

    Parameters
    ----------
    path
        YAML file.
    overrides
        Changes ``key=value`` of the scenario.
    kept
        What is kept while it is computed.
    progress
        Called with what is going on.

    Raises
    ------
    InputError
        If anything in the study is wrong; all problems are listed.
    NumericalError
        If a run fails.
    """
    study = load_uncertainty(path, overrides, progress)
    runs = kept.memory(
        "uncertainty", study.texts, digests_to_keep(kept, [study.loaded]), asked_again=True
    )
    report = find_uncertainty(
        study.loaded,
        study.of,
        study.parameters,
        method=study.method,
        number=study.number,
        seed=study.seed,
        limits=study.limits,
        progress=progress,
        runs=runs,
        mistakes=study.form.mistakes,
    )
    return replace(report, title=study.title)


def load_uncertainty(
    path: Path, overrides: Sequence[str] = (), progress: Progress = silent
) -> UncertaintyStudy:
    """Read a study file and check it against its scenario.

    Raises
    ------
    InputError
        If anything in it is wrong; all problems are listed.
    """
    form = StudyForm.read(path, required=_REQUIRED, optional=_OPTIONAL)
    of, method = _figures(form), form.choice("method", "first_order", METHODS)
    number = int(form.number("number", 256, least=2, most=MOST_RUNS, whole=True))
    seed = int(form.number("seed", 1, least=0, whole=True))
    parameters, limits = dict(form.entries(("parameters",))), dict(form.entries(("limits",)))
    for name in [name for name, item in limits.items() if not isinstance(item, dict)]:
        form.wrong(("limits", name), "expected a mapping")
        del limits[name]
    check_method(form.mistakes, method, number, limits, seed)
    loaded = None
    if "scenario" in form.data:
        changes = form.data.get("set")
        loaded = form.scenario(("scenario",), form.data["scenario"], changes, overrides)
    if loaded is not None:
        note_mistakes(
            form.mistakes, loaded, of=of, parameters=parameters, limits=limits, progress=progress
        )
    form.refuse()
    assert loaded is not None  # what is wrong with it was refused
    texts = (form.document.text, loaded.text, repr(loaded.overrides))
    title = str(form.data.get("title", path.stem))
    return UncertaintyStudy(
        title, loaded, of, parameters, method, number, seed, limits, texts, form
    )


def _figures(form: StudyForm) -> list[str]:
    of = form.data.get("of", [])
    names = [of] if isinstance(of, str) else of
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        form.wrong(("of",), "expected a figure, or a list of figures")
        return []
    return names


def table_of(report: UncertaintyReport) -> UncertaintyTable:
    """Return a report as a table for a result file."""
    n, m = len(report.parameters), len(report.figures)
    found = report.found

    def given(values: Any, shape: tuple[int, int], fill: float = np.nan) -> Any:
        return np.full(shape, fill) if values is None else values

    return UncertaintyTable(
        report.title,
        report.method,
        report.n_runs,
        report.parameters,
        report.figures,
        found.mean,
        found.deviation,
        found.mean_error,
        found.deviation_error,
        given(report.shares, (m, n)),
        given(report.totals, (m, n)),
        given(report.points, (0, n)),
        given(report.samples, (0, m)),
        tuple(map(risk_words, report.risks)),
        report.notes,
        given(report.shares_error, (m, n)),
        given(report.totals_error, (m, n)),
    )
