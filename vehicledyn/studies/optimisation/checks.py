"""Names and numbers of an optimisation study, checked against what its scenarios have."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.figure_names import wrong_figures
from vehicledyn.analyses.sensitivity.known_analyses import RUN, analysis_of
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.problems import Place
from vehicledyn.base.units import shown
from vehicledyn.studies.figures.by_analysis import quick_figures
from vehicledyn.studies.known_names import KnownNames, Parameters, unknown_parameter
from vehicledyn.studies.optimisation.scatter import Scatter
from vehicledyn.studies.optimisation.study import OptimisationStudy
from vehicledyn.studies.refused_values import refused_ends

Floats = NDArray[np.float64]


def note_mistakes(study: OptimisationStudy, progress: Progress) -> None:
    """Note names and numbers that mean nothing in the study's runs.

    Figures of slow analyses are known only when these are computed; what fails is left to the
    study to report.
    """
    form, places, units = study.form, study.places_of_figures(), dict[str, str]()
    for scenario, figures in study.figures_by_scenario().items():
        own = [name for name in figures if analysis_of(name) == RUN]
        place = ("scenarios", scenario) if scenario else ("scenarios",)
        others = {name: places[figure] for name, figure in figures.items() if name not in own}
        with suppress(NumericalError), form.mistakes.at(*place):
            for found in quick_figures(form.mistakes, study.scenarios[scenario], others, progress):
                check_numbers(study, found.parameters, found.model)
                units |= {figures[n]: unit for n, unit in found.units.items() if unit is not None}
        with suppress(NumericalError), form.mistakes.at(*place):
            known = KnownNames.of(study.scenarios[scenario], progress) if own else None
            if known is None:
                continue
            check_numbers(study, known.parameters, known.model)
            units |= {figures[name]: unit for name, unit in known.figure_units(own).items()}
            for name, words in wrong_figures(study.scenarios[scenario], own, progress).items():
                at = places[figures[name]]
                form.wrong(at, words, at_key=at[-1] == figures[name])
    check_limits(study, units)


def check_numbers(study: OptimisationStudy, parameters: Parameters, model: str) -> None:
    """Note what is wrong with variables and scatter by the parameters of a scenario."""
    names = [item.name for item in study.variables]
    for k, item in enumerate(study.variables):
        place = ("variables", item.key)
        if words := unknown_parameter(item.name, parameters, model, role="to vary"):
            study.form.wrong(place, words, at_key=True)
        elif item.name in names[:k]:
            other = study.variables[names.index(item.name)].key
            study.form.wrong(place, f"is the same parameter as '{other}'", at_key=True)
    known = {name: about.unit for name, (about, _) in parameters.items()}
    Scatter.of(study.form.mistakes, study.scatter, known, model)
    bounds = read_bounds(study, parameters)
    sound = {name: row for name, row in bounds.items() if np.isfinite(row).all()}
    refused = refused_ends(
        study.scenarios.values(),
        {name: (float(row[0]), float(row[1])) for name, row in sound.items()},
        {name: parameters[name][1] for name in sound},
        {name: parameters[name][0] for name in sound},
    )
    keys = {item.name: item.key for item in reversed(study.variables)}
    for name, words in refused.items():
        study.form.wrong(("variables", keys[name]), words)


def read_bounds(study: OptimisationStudy, parameters: Parameters) -> dict[str, Floats]:
    """Return lower and upper bound and start of the variables that are known, in SI.

    They are not numbers where something is wrong with them, which is noted.
    """
    found = {}
    for item in study.variables:
        if item.name not in parameters or item.name == "speed" or item.name in found:
            continue
        place: Place = ("variables", item.key)
        about, value = parameters[item.name]
        given = {"from": item.low, "to": item.high, "start": item.start}
        low, high, start = (
            value if text is None else study.form.mistakes.number((*place, key), text, about.unit)
            for key, text in given.items()
        )
        if low >= high:
            study.form.wrong(place, "from must be below to")
        elif start < low or start > high:
            words = (
                f"its start {shown(start, about.unit)} lies outside its bounds; give start or "
                "other bounds"
            )
            study.form.wrong(place, words)
        found[item.name] = np.array([low, high, start] if low < high else [np.nan] * 3)
    return found


def check_limits(study: OptimisationStudy, units: Mapping[str, str]) -> None:
    """Note limits, targets and sizes that are no numbers in the units of their figures.

    Figures whose unit is not known yet are passed over.
    """
    mistakes = study.form.mistakes
    found = {
        place: mistakes.number(place, value, units[figure])
        for figure, place, value in _quantities(study)
        if figure in units
    }
    for item in study.limits:
        place = ("constraints", item.figure)
        low, high = (found.get((*place, key), np.nan) for key in ("at_least", "at_most"))
        if low > high:
            mistakes.wrong(place, "at_least is above at_most")
    for target in study.targets:
        size = ("least_squares", target.figure, "size")
        if found.get(size, np.inf) <= 0.0:
            mistakes.wrong(size, "must be above zero")


def _quantities(study: OptimisationStudy) -> Iterator[tuple[str, Place, Any]]:
    """Yield the figures of limits, targets and sizes with places and values."""
    for item in study.limits:
        for key, value in (("at_least", item.at_least), ("at_most", item.at_most)):
            if value is not None:
                yield item.figure, ("constraints", item.figure, key), value
    for target in study.targets:
        for key, value in (("target", target.value), ("size", target.size)):
            yield target.figure, ("least_squares", target.figure, key), value
    if study.front is not None:
        key = "at_most" if study.front.is_upper else "at_least"
        for k, value in enumerate(study.front.values):
            yield study.front.figure, ("front", key, k), value
