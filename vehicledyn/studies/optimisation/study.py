"""What an optimisation study asks for: variables, figures, constraints, scenarios."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

from vehicledyn.base.errors import nearest_name
from vehicledyn.base.problems import Place
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.studies.study_form import StudyForm


@dataclass(frozen=True)
class Variable:
    """A parameter to vary, with texts or numbers for its bounds and start; None for its value.

    ``key`` is its name as the study writes it.
    """

    key: str
    low: Any
    high: Any
    start: Any = None

    @property
    def name(self) -> str:
        """Name of the parameter."""
        return self.key.removeprefix("parameters.")


@dataclass(frozen=True)
class Limit:
    """A figure with its limits, None where there is none."""

    figure: str
    at_least: Any = None
    at_most: Any = None


@dataclass(frozen=True)
class WantedFigure:
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
    """What is to be optimised; ``form`` is the file it was read from.

    ``scenarios`` by name; figures are ``SCENARIO/FIGURE``, or the figure alone where there is one
    scenario. ``weights`` are those of the sum to minimise, or ``targets`` what figures should be.
    ``starts`` is from how many points to search, the first of them the one given, ``explore`` how
    many runs to spend on a point to begin with; ``seed`` is that of both. Figures are their means
    plus ``deviations`` of them, to the worse side, under the distributions ``scatter``. ``choices``
    are the scenarios of all combinations of discrete settings, with what to call them.
    """

    form: StudyForm
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
    targets: tuple[WantedFigure, ...] = ()
    optimiser: str = "trust_region"
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

    def places_of_figures(self) -> dict[str, Place]:
        """Return where the study names each figure that it needs."""
        minimise = self.form.data.get("minimise")
        is_text = isinstance(minimise, str)
        found: dict[str, Place] = {
            name: ("minimise",) if is_text else ("minimise", name) for name in self.weights
        }
        found |= {item.figure: ("least_squares", item.figure) for item in self.targets}
        others = {item.figure: ("constraints", item.figure) for item in self.limits}
        others |= {} if self.front is None else {self.front.figure: ("front", "figure")}
        found = others | found
        return {name: found[name] for name in self.all_figures}

    def figures_by_scenario(self) -> dict[str, dict[str, str]]:
        """Return the figures that the study needs of each scenario: its names of them by theirs.

        What names no scenario is noted as wrong.
        """
        found: dict[str, dict[str, str]] = {name: {} for name in self.scenarios}
        for figure, place in self.places_of_figures().items():
            head, call, rest = figure.partition("(")
            scenario, _, name = head.rpartition("/")
            if scenario in found:
                found[scenario][f"{name}{call}{rest}"] = figure
            else:
                guess = nearest_name(scenario, found)
                hint = f"did you mean '{guess}'?" if guess else f"known: {', '.join(found)}"
                words = f"'{figure}' names no scenario; {hint}"
                self.form.wrong(place, words, at_key=place[-1] == figure)
        return found
