"""Figures of one scenario, analysis by analysis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress

from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.known_analyses import ANALYSES, RUN, analysis_of
from vehicledyn.base.errors import InputError, MissingPartError, NumericalError
from vehicledyn.base.problems import Place
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.studies.figures.analysis_figures import AnalysisFigures
from vehicledyn.studies.figures.run_figures import RunFigures, ScenarioFigures
from vehicledyn.studies.mistakes import Mistakes


def figures_of(
    mistakes: Mistakes,
    loaded: LoadedScenario,
    places: Mapping[str, Place],
    progress: Progress,
) -> list[ScenarioFigures]:
    """Return figures of a scenario, analysis by analysis; what is wrong with them is noted.

    Parameters
    ----------
    mistakes
        What is wrong in the study so far.
    loaded
        The scenario.
    places
        Names of the figures, those of the run checked, and where the study gives them.
    progress
        Called with what is going on.

    Raises
    ------
    NumericalError
        If the run or an analysis fails.
    """
    found: list[ScenarioFigures] = []
    for kind in dict.fromkeys(analysis_of(name) for name in places):
        own = [name for name in places if analysis_of(name) == kind]
        if kind == RUN:
            found.append(RunFigures.of(loaded, own, progress))
            continue
        progress(f"preparing {kind}", None)
        try:
            found.append(AnalysisFigures.of(loaded, kind, own))
        except InputError as error:
            wrong = _wrong_alone(loaded, kind, own) or {own[0]: str(error)}
            for name, words in wrong.items():
                mistakes.wrong(places[name], words, at_key=len(places[name]) > 1)
            if right := [name for name in own if name not in wrong]:
                found.append(AnalysisFigures.of(loaded, kind, right))
    return found


def quick_figures(
    mistakes: Mistakes,
    loaded: LoadedScenario,
    places: Mapping[str, Place],
    progress: Progress,
) -> list[ScenarioFigures]:
    """Return figures of analyses other than the run that take no longer than a check of a study.

    What is wrong with them is noted; an analysis that fails is left to the study to report. The
    arguments are those of :func:`figures_of`.
    """
    found: list[ScenarioFigures] = []
    kinds = dict.fromkeys(map(analysis_of, places))
    for kind in kinds:
        if kind == RUN or ANALYSES[kind].is_slow:
            continue
        own = {name: place for name, place in places.items() if analysis_of(name) == kind}
        with suppress(NumericalError, MissingPartError):
            found += figures_of(mistakes, loaded, own, progress)
    return found


def _wrong_alone(loaded: LoadedScenario, kind: str, names: Sequence[str]) -> dict[str, str]:
    """Return what is wrong with each figure of an analysis that is no figure on its own."""
    wrong = {}
    for name in names:
        try:
            AnalysisFigures.of(loaded, kind, [name])
        except InputError as error:
            wrong[name] = str(error)
    return wrong
