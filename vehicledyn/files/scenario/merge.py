"""A vehicle's parameters: the model's own, changed by what the scenario gives."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from pydantic import ValidationError

from vehicledyn.base.parameters import ParameterSet
from vehicledyn.base.problems import Place, Problem, dotted
from vehicledyn.base.validation_messages import UNKNOWN_KEY, words_of
from vehicledyn.base.yaml import read_yaml
from vehicledyn.files.scenario.sets import Scenario
from vehicledyn.files.scenario.sources import Sources

_COMPONENTS = ("x", "y", "z")
_ROOT = "parameters"


class Model(Protocol):
    """What a scenario needs to know of a vehicle.

    A model may also have ``parameter_file``, the path of the YAML file its default parameters
    come from; then a problem in them is reported with that file's line.
    """

    kind: str
    parameter_class: type[ParameterSet]

    @classmethod
    def default_parameters(cls) -> dict[str, Any]:
        """Return the model's own parameters as nested mappings."""


@dataclass
class _Merge:
    """Merged parameters, the places the scenario gave, and what is wrong with them."""

    given: set[Place] = field(default_factory=set)
    problems: list[tuple[Place, str]] = field(default_factory=list)

    def merge(self, default: Any, change: Any, place: Place) -> Any:
        if isinstance(change, dict) and isinstance(default, dict) and _same_kind(default, change):
            merged = dict(default)
            for key, value in change.items():
                merged[key] = self.merge(default.get(key), value, (*place, key))
            return merged
        if isinstance(change, dict) and isinstance(default, list | tuple):
            return self._components(list(default), change, place)
        self.given.add(place)
        return change

    def _components(self, vector: list[Any], change: dict[str, Any], place: Place) -> list[Any]:
        names = _COMPONENTS[: len(vector)]
        for key, value in change.items():
            self.given.add((*place, names.index(key) if key in names else key))
            if key in names:
                vector[names.index(key)] = value
            else:
                words = f"unknown component. Known: {', '.join(names)}"
                self.problems.append(((*place, key), words))
        return vector

    def is_given(self, place: Place) -> bool:
        """Return whether the scenario gave this value, one that holds it or a part of it."""
        size = len(place)
        return any(place[: len(g)] == g or g[:size] == place for g in self.given)

    def explanation(self, place: Place) -> Place | None:
        """Return the place, or the innermost set around it in which the scenario gave a value.

        A value of the model's own may not fit to its neighbours once these are changed. None
        if the scenario changed nothing there.
        """
        if self.is_given(place):
            return place
        wider = (place[:size] for size in range(len(place) - 1, 0, -1))
        return next((outer for outer in wider if self.is_given(outer)), None)


def merge_parameters(
    model: type[Model], changes: dict[str, Any], sources: Sources
) -> tuple[ParameterSet | None, list[Problem]]:
    """Return a model's parameters with the scenario's changes, and all that is wrong with them.

    Parameters
    ----------
    model
        Class of the vehicle.
    changes
        What the scenario gives under ``parameters``, any part of the nested set. A vector is
        changed whole or by its components x, y and z.
    sources
        Where the scenario's values came from.

    Returns
    -------
    ParameterSet or None
        The validated set; None if something is wrong.
    list of Problem
        Problems of changes point into the scenario, others to the model's own file.
    """
    merge = _Merge()
    merged = merge.merge(model.default_parameters(), changes, ())
    problems = [
        sources.problem((_ROOT, *place), words, at_key=True) for place, words in merge.problems
    ]
    try:
        parameters = model.parameter_class.model_validate(merged)
    except ValidationError as error:
        for line in error.errors():
            at_key = line["type"] == UNKNOWN_KEY
            place = merge.explanation(line["loc"])
            if place is None or (line["loc"], words_of(line)) in _own_faults(model):
                problems.append(_own_problem(model, line["loc"], words_of(line)))
            else:
                words = words_of(line) + (_choice_hint(place) if at_key else "")
                problems.append(sources.problem((_ROOT, *place), words, at_key=at_key))
        return None, problems
    return (None if problems else parameters), problems


def _choice_hint(place: Place) -> str:
    """Return where to set what is no parameter of the model but chosen for it, such as tyres."""
    if len(place) != 1 or place[0] not in Scenario.model_fields:
        return ""
    return f"; '{place[0]}' is outside 'parameters': set {place[0]} or {place[0]}.KEY"


def _same_kind(default: dict[str, Any], change: dict[str, Any]) -> bool:
    return change.get("kind", default.get("kind")) == default.get("kind")


def _own_faults(model: type[Model]) -> set[tuple[Place, str]]:
    """Return what is wrong with the model's own parameters, whatever the scenario says."""
    try:
        model.parameter_class.model_validate(model.default_parameters())
    except ValidationError as error:
        return {(line["loc"], words_of(line)) for line in error.errors()}
    return set()


def _own_problem(model: type[Model], place: Place, message: str) -> Problem:
    path: Path | None = getattr(model, "parameter_file", None)
    if path is None:
        return Problem(f"parameters of {model.kind}", None, dotted(place), message)
    return Sources(read_yaml(path)).problem(place, message)
