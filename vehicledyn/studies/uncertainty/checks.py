"""Names and numbers of an uncertainty study, checked against what its scenario has."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any

from vehicledyn.analyse.uncertainty import Distribution
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.figure_names import wrong_figures
from vehicledyn.analyses.sensitivity.known_analyses import RUN, analysis_of
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.problems import Place
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.studies.distributions import read_law
from vehicledyn.studies.figures.by_analysis import quick_figures
from vehicledyn.studies.known_names import KnownNames, Parameters, unknown_parameter
from vehicledyn.studies.mistakes import Mistakes
from vehicledyn.studies.refused_values import refused_ends

MOST_RUNS = 10_000_000
"""Runs of a study."""

_WITHOUT_RISK = ("first_order", "second_order")

_RARE = 1e-3
"""Chance of a value below or above which a model need not take it."""


def note_mistakes(
    mistakes: Mistakes,
    loaded: LoadedScenario,
    *,
    of: Sequence[str],
    parameters: Mapping[str, Any],
    limits: Mapping[str, Any],
    progress: Progress,
) -> None:
    """Note names and numbers that mean nothing in the run.

    Figures of slow analyses are known only when these are computed; what fails is left to the
    study to report.

    Parameters
    ----------
    mistakes
        What is wrong so far.
    loaded, of, parameters, limits
        The scenario, its figures, distributions of its parameters and limits of figures.
    progress
        Called with what is going on.
    """
    own = [name for name in of if analysis_of(name) == RUN]
    places = places_of(mistakes, of)
    if len({analysis_of(name) for name in of}) > 1:
        mistakes.wrong(("of",), "name figures of one analysis, of the run or another one")
    others = {name: place for name, place in places.items() if name not in own}
    with suppress(NumericalError), mistakes.at("scenario"):
        for found in quick_figures(mistakes, loaded, others, progress):
            read_laws(mistakes, loaded, parameters, found.parameters, found.model)
            check_limits(mistakes, limits, {**dict.fromkeys(of), **found.units})
    if own:
        with suppress(NumericalError), mistakes.at("scenario"):
            known = KnownNames.of(loaded, progress)
            read_laws(mistakes, loaded, parameters, known.parameters, known.model)
            units: dict[str, str | None] = dict.fromkeys(of)
            check_limits(mistakes, limits, units | known.figure_units(own))
            for name, words in wrong_figures(loaded, own, progress).items():
                mistakes.wrong(places[name], words)


def places_of(mistakes: Mistakes, of: Sequence[str]) -> dict[str, Place]:
    """Return where a study names its figures."""
    document = mistakes.document
    is_list = document is not None and isinstance(document.data.get("of"), list)
    return {name: ("of", number) if is_list else ("of",) for number, name in enumerate(of)}


def check_method(
    mistakes: Mistakes, method: str, number: int, limits: Mapping[str, Any], seed: int
) -> None:
    """Note a seed that is none, and a number of runs or limits that a method has no use for."""
    if seed < 0:
        mistakes.wrong(("seed",), f"{seed}: give a whole number of zero or more")
    if number > MOST_RUNS:
        mistakes.wrong(("number",), f"{number}: give {MOST_RUNS} or fewer")
    if number < 2 or (method == "sobol" and number & (number - 1)):
        words = f"{number}: at least 2, of Sobol indices a power of two"
        mistakes.wrong(("number",), words)
    if limits and method in _WITHOUT_RISK:
        mistakes.wrong(("limits",), "the risk of a limit needs samples; take another method")
    if not any(limits.values()) and method == "reliability":
        mistakes.wrong(("limits",), "a reliability needs one")


def check_limits(
    mistakes: Mistakes, limits: Mapping[str, Any], units: Mapping[str, str | None]
) -> None:
    """Note limits of what is no figure, and those that are no numbers in known units."""
    for name, given in limits.items():
        place: Place = ("limits", name)
        if name not in units:
            mistakes.wrong(place, "this is not among the figures asked for", at_key=True)
            continue
        for key, value in given.items():
            unit = units[name]
            if key not in ("at_most", "at_least"):
                mistakes.wrong(place, f"expected at_most or at_least, found '{key}'")
            elif unit is not None:
                mistakes.number((*place, key), value, unit)


def read_laws(
    mistakes: Mistakes,
    loaded: LoadedScenario,
    given: Mapping[str, Any],
    parameters: Parameters,
    model: str,
) -> dict[str, Distribution]:
    """Return the distributions of parameters by their names; what is wrong with them is noted."""
    laws: dict[str, Distribution] = {}
    keys: dict[str, str] = {}
    if not given:
        mistakes.wrong(("parameters",), "name at least one with its distribution")
    for key, item in given.items():
        name, place = key.removeprefix("parameters."), ("parameters", key)
        if words := unknown_parameter(name, parameters, model, role="that can scatter"):
            mistakes.wrong(place, words, at_key=True)
        elif name in keys:
            mistakes.wrong(place, f"is the same parameter as '{keys[name]}'", at_key=True)
        elif law := read_law(mistakes, place, item, parameters[name][0].unit):
            laws[name] = law
        keys.setdefault(name, key)
    refused = refused_ends(
        [loaded],
        {
            name: (float(own.law.ppf(_RARE)), float(own.law.ppf(1.0 - _RARE)))
            for name, own in laws.items()
        },
        {name: parameters[name][1] for name in laws},
        {name: parameters[name][0] for name in laws},
    )
    for name, words in refused.items():
        mistakes.wrong(("parameters", keys[name]), words)
    return laws
