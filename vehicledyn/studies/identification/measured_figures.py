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
from vehicledyn.base.errors import InputError
from vehicledyn.base.problems import Place
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.studies.identification.data_columns import DataColumn, in_si
from vehicledyn.studies.identification.measured_data import (
    CurveColumns,
    MeasuredCurve,
    read_curve,
    words_on_gaps,
)
from vehicledyn.studies.mistakes import Mistakes
from vehicledyn.studies.scenario_figures import AnalysisFigures, RunFigures, ScenarioFigures
from vehicledyn.studies.study_form import StudyForm

Floats = NDArray[np.float64]

KEYS = ("value", "over", "over_unit", "column", "unit", "noise", "relative_noise")

_CALL = re.compile(r"(\w+)\((.+)\)")
_OF_CURVES = ("over_unit", "column", "unit")
_PART = re.compile(r"(gain|phase|real|imaginary)\(")
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
    if match is None or analysis_of(name) == RUN:
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
    entries, curves, notes = {}, dict[str, MeasuredCurve](), list[str]()
    given: dict[str, MeasuredFigure] = {}
    for name, entry in form.entries((*where, "figures"), KEYS):
        place: Place = (*where, "figures", name)
        if ("value" in entry) == ("over" in entry):
            form.wrong(place, "give its 'value', or the column that it is a curve 'over'")
        elif not {"noise", "relative_noise"} & set(entry):
            form.wrong(place, "needs noise, or relative_noise")
        elif lone := [key for key in _OF_CURVES if key in entry and "over" not in entry]:
            form.wrong((*place, lone[0]), "is that of a curve; give what it is 'over', too")
        else:
            with form.mistakes.at(*place):
                if "over" in entry:
                    curves[name] = _curve(name, entry, data)
                    if curves[name].gaps:
                        notes.append(f"{name}: {words_on_gaps(curves[name].gaps)}")
                given[name] = _without_values(name, curves.get(name))
                entries[name] = entry
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
                curve = curves.get(item.name)
                items.append(_with_values(*given_by, data=data, curve=curve, unit=unit))
        groups.append(MeasuredFigures(found, tuple(items)))
    return tuple(groups), notes


def _curve(name: str, entry: Mapping[str, Any], data: Path | None) -> MeasuredCurve:
    """Return the curve that the data of an experiment give for a figure."""
    if data is None:
        raise InputError("a curve needs the 'data' of the experiment")
    units = (str(entry[key]) if key in entry else None for key in ("over_unit", "unit"))
    return read_curve(
        data, CurveColumns(str(entry["over"]), str(entry.get("column", name)), *units)
    )


def _without_values(name: str, curve: MeasuredCurve | None) -> MeasuredFigure:
    """Return a figure whose values are still to be read."""
    if curve is None:
        return MeasuredFigure(name, (name,), np.ones(1), np.zeros(1), np.zeros(1), "number")
    unit, nothing = curve.over_unit, np.zeros(len(curve.places))
    figures = tuple(at_place(name, f"{place:.15g} {unit}") for place in curve.places)
    return MeasuredFigure(name, figures, curve.places, nothing, nothing, f"{curve.over} [{unit}]")


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
    curve: MeasuredCurve | None,
    unit: str,
) -> MeasuredFigure:
    """Return a figure with its values, and the deviations of their noise, in SI."""
    count = len(mistakes.problems)
    noise = mistakes.number((*place, "noise"), entry["noise"], unit) if "noise" in entry else 0.0
    part = mistakes.number((*place, "relative_noise"), entry.get("relative_noise", 0.0), "1")
    if min(noise, part) < 0.0 or max(noise, part) == 0.0:
        mistakes.wrong(place, "the deviation of its noise must be above zero")
    if curve is not None and data is not None:
        values = _values_of_curve(data, item.name, curve.values, entry.get("unit"), unit)
    else:
        values = np.array([mistakes.number((*place, "value"), entry["value"], unit)])
    deviations = np.hypot(noise, part * values)
    if len(mistakes.problems) == count and not deviations.all():
        raise InputError("relative_noise leaves a value of zero without any; give 'noise' too")
    return replace(item, values=values, noise=deviations)


def _values_of_curve(data: Path, name: str, column: DataColumn, given: object, unit: str) -> Floats:
    """Return the values of a curve in SI; of complex ones those that the figure is of."""
    part = _PART.match(name)
    if not np.iscomplexobj(column.values) or part is None:
        return in_si(data, column, given, unit)
    if part[1] == "phase":
        return np.asarray(np.angle(column.values), dtype=float)
    parts = {"gain": np.abs(column.values), "real": column.values.real}
    values = parts.get(part[1], column.values.imag)
    return in_si(data, column._replace(values=values), given, unit)
