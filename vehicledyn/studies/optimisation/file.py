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
_MORE = ("tolerance", "most_runs", "starts", "seed", "front")
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
class Front:
    """A second figure and its limits one after the other, for a front of best compromises."""

    figure: str
    is_upper: bool
    values: tuple[Any, ...]

    def limit(self, value: Any) -> Limit:
        """Return one of its limits."""
        return Limit(self.figure, *((None, value) if self.is_upper else (value, None)))


@dataclass(frozen=True)
class OptimisationStudy:
    """What is to be optimised.

    ``scenarios`` by name; figures are ``SCENARIO/FIGURE``, or the figure alone where there is one
    scenario. ``weights`` are those of the sum to minimise. ``starts`` is from how many points to
    search, the first of them the one given; ``seed`` is that of the others.
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
    starts: int = 1
    seed: int = 1
    front: Front | None = None

    @property
    def all_figures(self) -> list[str]:
        """Names of all figures that the study needs."""
        others = [limit.figure for limit in self.limits]
        others += [] if self.front is None else [self.front.figure]
        return list(dict.fromkeys([*self.weights, *others]))


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
        int(data.get("starts", 1)),
        int(data.get("seed", 1)),
        _front(data.get("front")),
    )


def _front(given: dict[str, Any] | None) -> Front | None:
    if given is None:
        return None
    is_upper = "at_most" in given
    return Front(given["figure"], is_upper, tuple(given["at_most" if is_upper else "at_least"]))


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
    _check_front(data.get("front"), wrong)
    return found


def _check_front(given: Any, wrong: Any) -> None:
    """Report a front that names no figure, or no list of limits."""
    if given is None:
        return
    sides = [key for key in _LIMITS if isinstance(given, dict) and key in given]
    form = "expected a mapping with figure, and a list at_most or at_least"
    if len(sides) != 1 or set(given) != {"figure", sides[0]}:
        wrong(("front",), form)
    elif not isinstance(given[sides[0]], list) or not given[sides[0]]:
        wrong(("front", sides[0]), "expected a list of limits")
    elif not isinstance(given["figure"], str):
        wrong(("front", "figure"), "expected the name of a figure")


def _check_numbers(data: dict[str, Any], wrong: Any) -> None:
    """Report weights and settings that are no numbers."""
    wanted = data.get("minimise")
    numbers = wanted.values() if isinstance(wanted, dict) else []
    if any(isinstance(n, bool) or not isinstance(n, int | float) for n in numbers):
        wrong(("minimise",), "weights are numbers")
    for key, least in (("tolerance", 0.0), ("most_runs", 1), ("starts", 1), ("seed", 1)):
        number = data.get(key, least + 1)
        if isinstance(number, bool) or not isinstance(number, int | float) or number < least:
            wrong((key,), "expected a number above zero")


def _mapping(item: Any, name: str, wrong: Any) -> dict[str, Any]:
    if item is None or isinstance(item, dict):
        return item or {}
    wrong((name,), "expected a mapping")
    return {}
