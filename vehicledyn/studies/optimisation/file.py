"""Optimisation studies as files: variables, figure to minimise, constraints, scenarios."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from vehicledyn.analyse.optimise import METHODS
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.figure_names import check_figures
from vehicledyn.analyses.sensitivity.known_analyses import RUN, analysis_of
from vehicledyn.base.errors import InputError, NumericalError, nearest_name
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.studies.study_form import StudyForm

_REQUIRED = ("scenarios", "variables")
_OPTIONAL = (
    "title", "set", "minimise", "least_squares", "constraints", "optimiser", "tolerance",
    "most_runs", "starts", "explore", "seed", "front", "scatter", "deviations", "choices",
)  # fmt: skip
_MOST_CHOICES = 1000
_MOST_STARTS = 10_000
_VARIABLE = ("from", "to", "start")
_LIMITS, _TARGET = ("at_least", "at_most"), ("target", "size")


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
class Target:
    """A figure with what it should be, and the deviation from it that counts as one."""

    figure: str
    value: Any
    size: Any


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
    scenario. ``weights`` are those of the sum to minimise, or ``targets`` what figures should be.
    ``starts`` is from how many points to search, the first of them the one given, ``explore`` how
    many runs to spend on a point to begin with; ``seed`` is that of both. Figures are their means
    plus ``deviations`` of them, to the worse side, under the distributions ``scatter``. ``choices``
    are the scenarios of all combinations of discrete settings, with what to call them.
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
    targets: tuple[Target, ...] = ()
    optimiser: str = "slsqp"
    explore: int = 0
    scatter: dict[str, Any] = field(default_factory=dict)
    deviations: float = 3.0
    choices: tuple[tuple[str, dict[str, LoadedScenario]], ...] = ()

    def subjects(self) -> Iterator[LoadedScenario]:
        """Yield its scenarios, those of its choices too."""
        yield from self.scenarios.values()
        for _, scenarios in self.choices:
            yield from scenarios.values()

    @property
    def all_figures(self) -> list[str]:
        """Names of all figures that the study needs."""
        others = [target.figure for target in self.targets]
        others += [limit.figure for limit in self.limits]
        others += [] if self.front is None else [self.front.figure]
        return list(dict.fromkeys([*self.weights, *others]))

    def figures_by_scenario(self) -> dict[str, list[str]]:
        """Return the names of the figures that the study needs of each scenario.

        Raises
        ------
        InputError
            If a figure names no scenario.
        """
        found: dict[str, list[str]] = {name: [] for name in self.scenarios}
        for figure in self.all_figures:
            head, call, rest = figure.partition("(")
            scenario, _, name = head.rpartition("/")
            if scenario not in found:
                guess = nearest_name(scenario, found)
                hint = f"; did you mean '{guess}'?" if guess else ""
                raise InputError(f"{self.path}: '{figure}' names no scenario{hint}")
            found[scenario].append(f"{name}{call}{rest}")
        return found

    def check_figures(self, progress: Progress) -> None:
        """Refuse figures of runs that no run has; a run that fails is left to the study to report.

        Raises
        ------
        InputError
            If there is such a name.
        """
        for scenario, names in self.figures_by_scenario().items():
            try:
                own = [name for name in names if analysis_of(name) == RUN]
                if own:
                    with suppress(NumericalError):
                        check_figures(self.scenarios[scenario], own, progress)
            except InputError as error:
                raise InputError(f"{self.path}: {error}") from None


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
    form = StudyForm.read(path, required=_REQUIRED, optional=_OPTIONAL)
    variables = tuple(
        Variable(name.removeprefix("parameters."), v["from"], v["to"], v.get("start"))
        for name, v in form.entries(("variables",), _VARIABLE, needed=("from", "to"))
    )
    weights, front = _weights(form), _front(form)
    limits = tuple(Limit(n, v.get("at_least"), v.get("at_most")) for n, v in _limits(form))
    tolerance = form.number("tolerance", 1e-8, least=0.0)
    most_runs, seed = (
        int(form.number(key, default, least=1, whole=True))
        for key, default in (("most_runs", 200), ("seed", 1))
    )
    starts = int(form.number("starts", 1, least=1, most=_MOST_STARTS, whole=True))
    targets = tuple(
        Target(name, item["target"], item["size"])
        for name, item in form.entries(("least_squares",), _TARGET, needed=_TARGET)
    )
    if bool(weights) == bool(targets) and not form.problems:
        form.wrong(("minimise",), "give either minimise or least_squares")
    optimiser = form.choice("optimiser", "slsqp", METHODS)
    explore = int(form.number("explore", 0, least=0, whole=True))
    deviations = form.number("deviations", 3.0, least=0.0)
    scatter = dict(form.entries(("scatter",)))
    for name, item in scatter.items():
        if not isinstance(item, dict):
            form.wrong(("scatter", name), "expected a distribution, a mapping with kind")
    combinations = _combinations(form)
    given = form.data.get("scenarios")
    if not isinstance(given, str | dict):
        form.wrong(("scenarios",), "expected a path, or paths by name")
    form.refuse()
    places = {"": given} if isinstance(given, str) else dict(given or {})

    def scenarios(choice: dict[str, Any]) -> dict[str, LoadedScenario]:
        changes = form.data.get("set")
        if choice and (changes is None or isinstance(changes, dict)):
            changes = {**(changes or {}), **choice}
        return {
            str(name): form.scenario(("scenarios", name), place, changes, overrides)
            for name, place in places.items()
        }

    choices = tuple(
        (", ".join(f"{key} = {value!s:.60}" for key, value in item.items()), scenarios(item))
        for item in combinations
    )
    return OptimisationStudy(
        path,
        form.document.text,
        str(form.data.get("title", path.stem)),
        choices[0][1] if choices else scenarios({}),
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
        choices,
    )


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
