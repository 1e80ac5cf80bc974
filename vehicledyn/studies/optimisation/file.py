"""Optimisation studies as files: variables, figure to minimise, constraints, scenarios."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from vehicledyn.base.problems import START, Problem, refusal
from vehicledyn.base.yaml import Document, read_yaml
from vehicledyn.files.scenario import LoadedScenario, load_scenario
from vehicledyn.files.scenario.settings import override_texts
from vehicledyn.studies.study_form import located

_KEYS = ("title", "scenarios", "set", "variables", "minimise", "constraints")
_MORE = ("tolerance", "most_runs")
_VARIABLE = ("from", "to", "start")
_LIMITS = ("at_least", "at_most")


@dataclass(frozen=True)
class Variable:
    """A parameter to vary, with texts or numbers for its bounds and start; None for its value."""

    name: str
    low: Any
    high: Any
    start: Any = None


@dataclass(frozen=True)
class Limit:
    """A figure with its limits, None where there is none."""

    figure: str
    at_least: Any = None
    at_most: Any = None


@dataclass(frozen=True)
class OptimisationStudy:
    """What is to be optimised.

    ``scenarios`` by name; figures are ``SCENARIO/FIGURE``, or the figure alone where there is one
    scenario. ``weights`` are those of the sum to minimise.
    """

    path: Path
    text: str
    title: str
    scenarios: dict[str, LoadedScenario]
    variables: tuple[Variable, ...]
    weights: dict[str, float]
    limits: tuple[Limit, ...]
    tolerance: float
    most_runs: int


def load_optimisation(path: Path, overrides: Sequence[str] = ()) -> OptimisationStudy:
    """Read and validate a study.

    Parameters
    ----------
    path
        YAML file.
    overrides
        Changes ``key=value`` of all scenarios.

    Raises
    ------
    InputError
        If anything is wrong; all problems of the file are listed, those of a scenario alone.
    """
    document = read_yaml(path)
    problems = [*document.problems, *_problems(document)]
    if problems:
        raise refusal(problems, document.name)
    data = document.data
    given = data["scenarios"]
    places = {"": given} if isinstance(given, str) else given
    changes = [*override_texts(data.get("set") or {}, {}), *overrides]
    scenarios = {
        name: load_scenario(located(path, place), changes) for name, place in places.items()
    }
    wanted = data["minimise"]
    weights = {wanted: 1.0} if isinstance(wanted, str) else dict(wanted)
    return OptimisationStudy(
        path,
        document.text,
        str(data.get("title", path.stem)),
        scenarios,
        tuple(
            Variable(name.removeprefix("parameters."), v["from"], v["to"], v.get("start"))
            for name, v in data["variables"].items()
        ),
        {name: float(weight) for name, weight in weights.items()},
        tuple(Limit(name, **limits) for name, limits in (data.get("constraints") or {}).items()),
        float(data.get("tolerance", 1e-8)),
        int(data.get("most_runs", 200)),
    )


def _problems(document: Document) -> list[Problem]:
    """Return all that is wrong with the form of a study."""
    data, found = document.data, list[Problem]()

    def wrong(place: tuple[Any, ...], words: str) -> None:
        mark = document.values.get(place) or document.keys.get(place) or START
        found.append(Problem(document.name, mark, ".".join(map(str, place)) or "file", words))

    if not isinstance(data, dict):
        wrong((), "a study is a mapping with scenarios, variables and minimise")
        return found
    for key in data:
        if key not in (*_KEYS, *_MORE):
            wrong((key,), f"unknown key. Known: {', '.join((*_KEYS, *_MORE))}")
    for key in ("scenarios", "variables", "minimise"):
        if not data.get(key):
            wrong((key,), "missing")
    if not isinstance(data.get("scenarios", ""), str | dict):
        wrong(("scenarios",), "expected a path, or paths by name")
    for group, keys in (("variables", _VARIABLE), ("constraints", _LIMITS)):
        for name, item in _mapping(data.get(group), group, wrong).items():
            if not isinstance(item, dict) or not item or set(item) - set(keys):
                wrong((group, name), f"expected a mapping with {', '.join(keys)}")
            elif group == "variables" and not {"from", "to"} <= set(item):
                wrong((group, name), "needs from and to")
    _check_numbers(data, wrong)
    return found


def _check_numbers(data: dict[str, Any], wrong: Any) -> None:
    """Report weights and settings that are no numbers."""
    wanted = data.get("minimise")
    numbers = wanted.values() if isinstance(wanted, dict) else []
    if any(isinstance(n, bool) or not isinstance(n, int | float) for n in numbers):
        wrong(("minimise",), "weights are numbers")
    for key, least in (("tolerance", 0.0), ("most_runs", 1)):
        number = data.get(key, least + 1)
        if isinstance(number, bool) or not isinstance(number, int | float) or number < least:
            wrong((key,), "expected a number above zero")


def _mapping(item: Any, name: str, wrong: Any) -> dict[str, Any]:
    if item is None or isinstance(item, dict):
        return item or {}
    wrong((name,), "expected a mapping")
    return {}
