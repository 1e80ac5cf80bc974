"""Measured figures of an experiment: once, or as a curve over places, such as frequencies."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.figure_names import wrong_figures
from vehicledyn.analyses.sensitivity.known_analyses import RUN, analysis_of
from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.base.files.column_files import ColumnKind, read_columns, stated_units
from vehicledyn.base.problems import Place
from vehicledyn.base.units import parse_unit
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.studies.identification.measured_data import words_on_gaps
from vehicledyn.studies.mistakes import Mistakes
from vehicledyn.studies.scenario_figures import AnalysisFigures, RunFigures, ScenarioFigures
from vehicledyn.studies.study_form import StudyForm

Floats = NDArray[np.float64]

KEYS = ("value", "over", "column", "noise", "relative_noise")

_CALL = re.compile(r"(\w+)\((.+)\)")
_PHASE = re.compile(r"phase\(|steady\(\w+_phase\b")


@dataclass(frozen=True)
class MeasuredFigure:
    """A figure that was measured, with one value or with a curve of them.

    ``name`` is what the study calls it; ``figures`` (m,) those of each value, ``values`` (m,) in
    SI, ``noise`` (m,) their deviations; ``places`` (m,) where on the curve, in the unit of
    ``over``, numbers from one for a figure that is none.
    """

    name: str
    figures: tuple[str, ...]
    places: Floats
    values: Floats
    noise: Floats
    over: str

    @property
    def is_phase(self) -> bool:
        """Whether whole turns mean nothing."""
        return _PHASE.match(self.name) is not None


@dataclass(frozen=True)
class MeasuredFigures:
    """Measured figures of a run or of one analysis of a scenario, and what finds them."""

    of: ScenarioFigures
    items: tuple[MeasuredFigure, ...]


def at_place(name: str, place: str) -> str:
    """Return the figure at a place of a curve.

    Examples
    --------
    >>> at_place("rig(left.toe_angle, parallel, travel=0 mm)", "20 mm")
    'rig(left.toe_angle, parallel, 20 mm, travel=0 mm)'

    Raises
    ------
    InputError
        If the name is not that of a curve.
    """
    match = _CALL.fullmatch(name)
    if match is None:
        raise InputError(f"'{name}' has no places; leave 'over' out and give its 'value'")
    parts = [part.strip() for part in match[2].split(",")]
    behind = next((k for k, part in enumerate(parts) if "=" in part), len(parts))
    return f"{match[1]}({', '.join([*parts[:behind], place, *parts[behind:]])})"


def read_figures(
    form: StudyForm, where: Place, loaded: LoadedScenario, data: Path | None, progress: Progress
) -> tuple[tuple[MeasuredFigures, ...], list[str]]:
    """Return the measured figures of an experiment, and remarks on their gaps.

    What is wrong with them is noted.

    Parameters
    ----------
    form
        The study.
    where
        Place of the experiment in it.
    loaded
        The experiment's scenario.
    data
        File of the curves, None if there is none.
    progress
        Called with what is going on.

    Raises
    ------
    NumericalError
        If the run or an analysis fails.
    """
    entries, notes = {}, list[str]()
    given: dict[str, MeasuredFigure] = {}
    for name, entry in form.entries((*where, "figures"), KEYS):
        place: Place = (*where, "figures", name)
        if ("value" in entry) == ("over" in entry):
            form.wrong(place, "give its 'value', or the column that it is a curve 'over'")
        elif not {"noise", "relative_noise"} & set(entry):
            form.wrong(place, "needs noise, or relative_noise")
        else:
            with form.mistakes.at(*place):
                given[name], lost = _curve(name, entry, data)
                entries[name] = entry
                if lost:
                    notes.append(f"{name}: {words_on_gaps(lost)}")
    groups = []
    for kind in dict.fromkeys(map(analysis_of, given)):
        own = {name: item for name, item in given.items() if analysis_of(name) == kind}
        places = {name: (*where, "figures", name) for name in own}
        found, right = _found(form.mistakes, places, loaded, kind, own, progress=progress)
        if found is None:
            continue
        items = []
        for item in right:
            unit = found.units[item.figures[0]] or "1"
            with form.mistakes.at(*places[item.name]):
                given_by = form.mistakes, places[item.name], item, entries[item.name]
                items.append(_with_values(*given_by, data=data, unit=unit))
        groups.append(MeasuredFigures(found, tuple(items)))
    return tuple(groups), notes


def _curve(name: str, entry: Mapping[str, Any], data: Path | None) -> tuple[MeasuredFigure, int]:
    """Return a figure whose values are still to be read, and how many places have none."""
    if "over" not in entry:
        return MeasuredFigure(name, (name,), np.ones(1), np.zeros(1), np.zeros(1), "number"), 0
    if data is None:
        raise InputError("a curve needs the 'data' of the experiment")
    column, over = str(entry.get("column", name)), str(entry["over"])
    units = stated_units(data)
    for wanted in (over, column):
        if wanted not in units:
            guess = nearest_name(wanted, units)
            hint = f"; did you mean '{guess}'?" if guess else ""
            words = f"has no column '{wanted}' with its unit in brackets{hint}"
            raise InputError(f"{data}: {words}")
    known = {over: ColumnKind(units[over], required=True)}
    known[column] = ColumnKind(units[column], may_be_nan=True)
    table = read_columns(data, known, is_open=True)
    kept = np.isfinite(table.numbers[column])
    if not kept.any():
        raise InputError(f"{data}: column '{column}' has no value; all are gaps")
    places = np.array(table.numbers[over])[kept] / parse_unit(units[over]).factor
    figures = tuple(at_place(name, f"{place:.15g} {units[over]}") for place in places)
    nothing = np.zeros(len(places))
    lost = int((~kept).sum())
    return MeasuredFigure(name, figures, places, nothing, nothing, f"{over} [{units[over]}]"), lost


def _found(
    mistakes: Mistakes,
    places: Mapping[str, Place],
    loaded: LoadedScenario,
    kind: str,
    own: Mapping[str, MeasuredFigure],
    *,
    progress: Progress,
) -> tuple[ScenarioFigures | None, list[MeasuredFigure]]:
    """Return what finds the figures of a run or an analysis, and those that mean something."""
    wrong: dict[str, str] = {}
    if kind == RUN:
        wrong = wrong_figures(loaded, list(own), progress)
    else:
        progress(f"preparing {kind}", None)
        try:
            return AnalysisFigures.of(loaded, kind, _figures(own.values())), list(own.values())
        except InputError as error:
            for name, item in own.items():
                try:
                    AnalysisFigures.of(loaded, kind, _figures([item]))
                except InputError as alone:
                    wrong[name] = str(alone)
            wrong = wrong or {next(iter(own)): str(error)}
    for name, words in wrong.items():
        mistakes.wrong(places[name], words, at_key=True)
    right = [item for name, item in own.items() if name not in wrong]
    if not right:
        return None, []
    if kind == RUN:
        return RunFigures.of(loaded, [item.name for item in right], progress), right
    return AnalysisFigures.of(loaded, kind, _figures(right)), right


def _figures(items: Any) -> list[str]:
    """Return the names of figures, each once."""
    return list(dict.fromkeys(name for item in items for name in item.figures))


def _with_values(
    mistakes: Mistakes,
    place: Place,
    item: MeasuredFigure,
    entry: Mapping[str, Any],
    *,
    data: Path | None,
    unit: str,
) -> MeasuredFigure:
    """Return a figure with its values, and the deviations of their noise, in SI."""
    count = len(mistakes.problems)
    noise = mistakes.number((*place, "noise"), entry["noise"], unit) if "noise" in entry else 0.0
    part = mistakes.number((*place, "relative_noise"), entry.get("relative_noise", 0.0), "1")
    if min(noise, part) < 0.0 or max(noise, part) == 0.0:
        mistakes.wrong(place, "the deviation of its noise must be above zero")
    if "over" in entry and data is not None:
        column = str(entry.get("column", item.name))
        known = {column: ColumnKind(unit, may_be_nan=True)}
        values = np.array(read_columns(data, known, is_open=True).numbers[column])
        values = values[np.isfinite(values)]
    else:
        values = np.array([mistakes.number((*place, "value"), entry["value"], unit)])
    deviations = np.hypot(noise, part * values)
    if len(mistakes.problems) == count and not deviations.all():
        raise InputError("relative_noise leaves a value of zero without any; give 'noise' too")
    return replace(item, values=values, noise=deviations)
