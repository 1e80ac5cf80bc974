"""Optimisation studies read from files."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from vehicledyn.analyse.optimise import METHODS
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.base.problems import Place
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.studies.mistakes import silent
from vehicledyn.studies.optimisation.checks import note_mistakes
from vehicledyn.studies.optimisation.study import (
    Front,
    Limit,
    OptimisationStudy,
    Variable,
    WantedFigure,
)
from vehicledyn.studies.study_form import LARGEST, StudyForm

_REQUIRED = ("scenarios", "variables")
_OPTIONAL = (
    "title", "set", "minimise", "least_squares", "constraints", "optimiser", "tolerance",
    "most_runs", "starts", "explore", "seed", "front", "scatter", "deviations", "choices",
)  # fmt: skip
_MOST_CHOICES = 1000
_MOST_STARTS = 10_000
_VARIABLE = ("from", "to", "start")
_LIMITS, _TARGET = ("at_least", "at_most"), ("target", "size")


def load_optimisation(
    path: Path, overrides: Sequence[str] = (), progress: Progress = silent
) -> OptimisationStudy:
    """Read a study and check it against its scenarios.

    Parameters
    ----------
    path
        YAML file.
    overrides
        Changes ``key=value`` of all scenarios.
    progress
        Called with what is going on.

    Raises
    ------
    InputError
        If anything is wrong; all problems of the file and of its scenarios are listed.
    """
    form = StudyForm.read(path, required=_REQUIRED, optional=_OPTIONAL)
    variables = tuple(
        Variable(name, v["from"], v["to"], v.get("start"))
        for name, v in form.entries(("variables",), _VARIABLE, needed=("from", "to"))
    )
    weights, front = _weights(form), _front(form)
    limits = tuple(Limit(n, v.get("at_least"), v.get("at_most")) for n, v in _limits(form))
    most_runs, seed = (
        int(form.number(key, default, least=1, whole=True))
        for key, default in (("most_runs", 200), ("seed", 1))
    )
    starts = int(form.number("starts", 1, least=1, most=_MOST_STARTS, whole=True))
    targets = tuple(
        WantedFigure(name, item["target"], item["size"])
        for name, item in form.entries(("least_squares",), _TARGET, needed=_TARGET)
    )
    if bool(weights) == bool(targets) and not form.mistakes.problems:
        form.wrong(("minimise",), "give either minimise or least_squares")
    optimiser = form.choice("optimiser", METHODS[0], METHODS)
    tolerance = form.number("tolerance", 1e-8, least=0.0)
    explore = int(form.number("explore", 0, least=0, whole=True))
    deviations = form.number("deviations", 3.0, least=0.0)
    scatter = dict(form.entries(("scatter",)))
    combinations = _combinations(form)
    groups, is_whole = _scenarios(form, combinations or [{}], overrides)
    names = (", ".join(f"{key} = {v!s:.60}" for key, v in item.items()) for item in combinations)
    study = OptimisationStudy(
        form,
        str(form.data.get("title", path.stem)),
        groups[0],
        variables,
        weights,
        limits,
        tolerance,
        most_runs,
        starts,
        seed,
        front,
        targets,
        optimiser,
        explore,
        scatter,
        deviations,
        tuple(zip(names, groups, strict=is_whole)) if combinations else (),
    )
    if is_whole:
        note_mistakes(study, progress)
    form.refuse()
    return study


def _scenarios(
    form: StudyForm, combinations: list[dict[str, Any]], overrides: Sequence[str]
) -> tuple[list[dict[str, LoadedScenario]], bool]:
    """Return the scenarios by name with each combination of settings, and whether all are there."""
    given = form.data.get("scenarios")
    changes = form.data.get("set") or {}
    if not isinstance(changes, dict):
        form.wrong(("set",), "expected a mapping of changes")
        changes = {}
    places: dict[str, tuple[Place, Any]] = {}
    if isinstance(given, str):
        places = {"": (("scenarios",), given)}
    elif isinstance(given, dict):
        places = {str(name): (("scenarios", name), item) for name, item in given.items()}
    elif "scenarios" in form.data:
        form.wrong(("scenarios",), "expected a path, or paths by name")
    groups = []
    for choice in combinations:
        found = {
            name: form.scenario(
                *item, {**changes, **choice}, overrides, groups=(("choices",), ("set",))
            )
            for name, item in places.items()
        }
        groups.append({name: item for name, item in found.items() if item is not None})
        if not found or len(groups[-1]) < len(found):
            return groups, False
    return groups, True


def _combinations(form: StudyForm) -> list[dict[str, Any]]:
    """Return all combinations of discrete settings, none where there are none."""
    given = form.data.get("choices")
    if given is None:
        return []
    if not isinstance(given, dict) or not given:
        form.wrong(("choices",), "expected a mapping of settings to lists of their values")
        return []
    for key, values in given.items():
        if not isinstance(values, list) or not values:
            form.wrong(("choices", key), "expected a list of values")
            return []
    if math.prod(len(values) for values in given.values()) > _MOST_CHOICES:
        form.wrong(("choices",), f"these are more than {_MOST_CHOICES} combinations")
        return []
    return [
        dict(zip(map(str, given), item, strict=True)) for item in itertools.product(*given.values())
    ]


def _weights(form: StudyForm) -> dict[str, float]:
    """Return the weights of the figures to minimise."""
    wanted = form.data.get("minimise")
    if wanted is None and "least_squares" in form.data:
        return {}
    if isinstance(wanted, str):
        return {wanted: 1.0}
    if not isinstance(wanted, dict):
        form.wrong(("minimise",), "expected a figure, or weights of figures")
        return {}
    weights = {}
    for name, weight in wanted.items():
        if isinstance(weight, bool) or not isinstance(weight, int | float):
            form.wrong(("minimise", name), "expected a number, the weight of the figure")
        elif not weight or not abs(weight) <= LARGEST:
            words = f"expected a weight that is not zero, and of at most {LARGEST:g}"
            form.wrong(("minimise", name), words)
        else:
            weights[str(name)] = float(weight)
    return weights


def _limits(form: StudyForm) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the limits of figures by name."""
    for name, item in form.entries(("constraints",), _LIMITS):
        if item:
            yield name, item
        else:
            form.wrong(("constraints", name), f"needs {' or '.join(_LIMITS)}")


def _front(form: StudyForm) -> Front | None:
    """Return the second figure of a front; nothing where none is wanted or it is wrong."""
    given = form.data.get("front")
    if given is None:
        return None
    sides = [key for key in _LIMITS if isinstance(given, dict) and key in given]
    if len(sides) != 1 or set(given) != {"figure", sides[0]}:
        form.wrong(("front",), "expected a mapping with figure, and a list at_most or at_least")
    elif not isinstance(given[sides[0]], list) or not given[sides[0]]:
        form.wrong(("front", sides[0]), "expected a list of limits")
    elif not isinstance(given["figure"], str):
        form.wrong(("front", "figure"), "expected the name of a figure")
    else:
        return Front(given["figure"], sides[0] == "at_most", tuple(given[sides[0]]))
    return None
