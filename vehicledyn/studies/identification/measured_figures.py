"""Measured figures of an experiment: once, or as a curve over places, such as frequencies."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.key_figures import KINDS
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.figure_names import wrong_figures
from vehicledyn.analyses.sensitivity.known_analyses import RUN, analysis_of
from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.base.problems import Place
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.studies.figures.analysis_figures import AnalysisFigures
from vehicledyn.studies.figures.run_figures import RunFigures, ScenarioFigures
from vehicledyn.studies.identification.data_columns import DataColumn, in_si, numbers_of
from vehicledyn.studies.identification.measured_data import (
    CurveColumns,
    MeasuredCurve,
    curve_of_columns,
    read_curve,
    words_on_gaps,
)
from vehicledyn.studies.known_names import KnownNames
from vehicledyn.studies.mistakes import Mistakes
from vehicledyn.studies.study_form import StudyForm

Floats = NDArray[np.float64]

KEYS = ("value", "over", "over_unit", "column", "unit", "noise", "relative_noise")

_SUCH = {
    **{part: f"{part}(CHANNEL, INPUT)" for part in ("gain", "phase", "real", "imaginary")},
    "rig": "rig(wheel.toe_angle, parallel)",
    "kinematics": "kinematics(wheel.toe_angle, wheel.z)",
    "steady": "steady(roll_angle, constant_radius)",
}
_CURVES = tuple(_SUCH)
_CALL = re.compile(r"(\w+)\((.+)\)")
GIVEN_KEYS = ("value", "over", "over_unit", "values", "unit", "noise", "relative_noise")
"""What a figure is given by in a study, and in Python."""

_OF_CURVES = ("over_unit", "column", "values", "unit")
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
        raise InputError(f"'{name}' {_no_curve(name)}")
    parts = [part.strip() for part in match[2].split(",")]
    behind = next((k for k, part in enumerate(parts) if "=" in part), len(parts))
    return f"{match[1]}({', '.join([*parts[:behind], place, *parts[behind:]])})"


def _no_curve(name: str) -> str:
    """Return why a name is not that of a curve."""
    kind, is_call, _ = name.partition("(")
    if kind in _CURVES:
        return f"names too little; a curve over places is such as {_SUCH[kind]}"
    if not is_call or kind in KINDS:
        return "has no places; leave 'over' out and give its 'value'"
    guess = nearest_name(kind, [*_CURVES, *KINDS])
    hint = f"; did you mean '{guess}'?" if guess else "."
    return (
        f"is an unknown figure{hint} Curves over places are {', '.join(_CURVES)}, and figures of "
        f"one 'value' are {', '.join(KINDS)} of a channel"
    )


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
    entries = dict(form.entries((*where, "figures"), KEYS))

    def curve(name: str, entry: Mapping[str, Any]) -> MeasuredCurve:
        return _curve_of_file(name, entry, data)

    return _measured(form.mistakes, where, loaded, entries, curve, source=str(data), tell=progress)


def given_figures(
    mistakes: Mistakes,
    loaded: LoadedScenario,
    figures: Mapping[str, Mapping[str, Any]],
    progress: Progress,
) -> tuple[tuple[MeasuredFigures, ...], list[str]]:
    """Return measured figures that are given as numbers and arrays, and remarks on their gaps.

    What is wrong with them is noted.

    Parameters
    ----------
    mistakes
        What is wrong so far.
    loaded
        The scenario.
    figures
        By name a mapping with ``value``; or, for a curve, ``over`` with its ``over_unit``,
        and ``values`` with their ``unit``, None for SI; and ``noise``, ``relative_noise`` or both.
    progress
        Called with what is going on.

    Raises
    ------
    NumericalError
        If the run or an analysis fails.
    """
    for name, entry in figures.items():
        mistakes.check_keys(("figures", name), entry, GIVEN_KEYS)
    return _measured(mistakes, (), loaded, figures, _given_curve, source="values", tell=progress)


def known_names(
    loaded: LoadedScenario,
    figures: Sequence[MeasuredFigures],
    *,
    is_run: bool,
    progress: Progress,
) -> KnownNames:
    """Return what names of an experiment mean; one without a run has no channels and starts."""
    if is_run or not figures:
        return KnownNames.of(loaded, progress)
    parameters = {name: own for group in figures for name, own in group.of.parameters.items()}
    return KnownNames(figures[0].of.model, parameters, {}, {})


def _measured(
    mistakes: Mistakes,
    where: Place,
    loaded: LoadedScenario,
    given: Mapping[str, Mapping[str, Any]],
    curve: Callable[[str, Mapping[str, Any]], MeasuredCurve],
    *,
    source: str,
    tell: Progress,
) -> tuple[tuple[MeasuredFigures, ...], list[str]]:
    """Return the measured figures of an experiment at a place, and remarks on their gaps.

    ``curve`` gives the curve of an entry that is one; ``source`` is what its values come from.
    """
    curves, notes = dict[str, MeasuredCurve](), list[str]()
    without_values: dict[str, MeasuredFigure] = {}
    for name, entry in given.items():
        place: Place = (*where, "figures", name)
        if ("value" in entry) == ("over" in entry):
            mistakes.wrong(place, "give its 'value', or the column that it is a curve 'over'")
        elif not {"noise", "relative_noise"} & set(entry):
            mistakes.wrong(place, "needs noise, or relative_noise")
        elif lone := [key for key in _OF_CURVES if key in entry and "over" not in entry]:
            mistakes.wrong((*place, lone[0]), "is that of a curve; give what it is 'over', too")
        else:
            with mistakes.at(*place):
                if "over" in entry:
                    curves[name] = curve(name, entry)
                    if curves[name].gaps:
                        notes.append(f"{name}: {words_on_gaps(curves[name].gaps)}")
                without_values[name] = _without_values(name, curves.get(name))
    groups = []
    for kind in dict.fromkeys(map(analysis_of, without_values)):
        own = {name: item for name, item in without_values.items() if analysis_of(name) == kind}
        places = {name: (*where, "figures", name) for name in own}
        found, right = _found(mistakes, places, loaded, kind, own, progress=tell)
        if found is None:
            continue
        items = []
        for item in right:
            unit = found.units[item.figures[0]] or "1"
            with mistakes.at(*places[item.name]):
                given_by = mistakes, places[item.name], item, given[item.name]
                values = curves.get(item.name)
                items.append(_with_values(*given_by, source=source, curve=values, unit=unit))
        groups.append(MeasuredFigures(found, tuple(items)))
    return tuple(groups), notes


def _curve_of_file(name: str, entry: Mapping[str, Any], data: Path | None) -> MeasuredCurve:
    """Return the curve that the data of an experiment give for a figure."""
    if data is None:
        raise InputError("a curve needs the 'data' of the experiment")
    units = (str(entry[key]) if key in entry else None for key in ("over_unit", "unit"))
    return read_curve(
        data, CurveColumns(str(entry["over"]), str(entry.get("column", name)), *units)
    )


def _given_curve(name: str, entry: Mapping[str, Any]) -> MeasuredCurve:
    """Return the curve that arrays give for a figure."""
    if "values" not in entry:
        raise InputError("needs 'values', one for each place that it is 'over'")
    unit = entry.get("over_unit")
    over, values = (_given_column(key, entry[key]) for key in ("over", "values"))
    return curve_of_columns("figures", over, values, None if unit is None else str(unit))


def _given_column(key: str, values: Any) -> DataColumn:
    """Return the column that an array is."""
    try:
        array = np.asarray(values)
    except (TypeError, ValueError):
        raise InputError(f"{key}: expected an array of numbers") from None
    return DataColumn(key, numbers_of(key, key, array))


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
    source: str,
    curve: MeasuredCurve | None,
    unit: str,
) -> MeasuredFigure:
    """Return a figure with its values, and the deviations of their noise, in SI."""
    count = len(mistakes.problems)
    noise = mistakes.number((*place, "noise"), entry["noise"], unit) if "noise" in entry else 0.0
    part = mistakes.number((*place, "relative_noise"), entry.get("relative_noise", 0.0), "1")
    if min(noise, part) < 0.0 or max(noise, part) == 0.0:
        mistakes.wrong(place, "the deviation of its noise must be above zero")
    if curve is not None:
        given_unit = entry.get("unit", unit if "values" in entry else None)  # arrays are in SI
        values = _values_of_curve(source, item.name, curve.values, given_unit, unit)
    else:
        values = np.array([mistakes.number((*place, "value"), entry["value"], unit)])
    deviations = np.hypot(noise, part * values)
    if len(mistakes.problems) == count and not deviations.all():
        raise InputError("relative_noise leaves a value of zero without any; give 'noise' too")
    return replace(item, values=values, noise=deviations)


def _values_of_curve(
    source: str, name: str, column: DataColumn, given: object, unit: str
) -> Floats:
    """Return the values of a curve in SI; of complex ones those that the figure is of."""
    part = _PART.match(name)
    if not np.iscomplexobj(column.values) or part is None:
        return in_si(source, column, given, unit)
    if part[1] == "phase":
        return np.asarray(np.angle(column.values), dtype=float)
    parts = {"gain": np.abs(column.values), "real": column.values.real}
    values = parts.get(part[1], column.values.imag)
    return in_si(source, column._replace(values=values), given, unit)
