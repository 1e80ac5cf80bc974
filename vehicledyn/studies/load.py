"""From a study file to cases that may run; every problem of the file is reported at once."""

from __future__ import annotations

import copy
import json
import math
from array import array
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.base.errors import InputError
from vehicledyn.base.parameters import units_of
from vehicledyn.base.problems import START, Place, Problem, dotted, refusal
from vehicledyn.base.units import describe
from vehicledyn.base.validation_messages import UNKNOWN_KEY, words_of
from vehicledyn.base.yaml import Document, read_yaml
from vehicledyn.files.scenario.bare_numbers import bare_numbers
from vehicledyn.files.scenario.load import LoadedScenario
from vehicledyn.files.scenario.overrides import Change, apply_change, read_override
from vehicledyn.files.scenario.sources import Sources
from vehicledyn.studies.axes import Axis, Design, quantity_text
from vehicledyn.studies.columns import Written, read_columns
from vehicledyn.studies.recipe import Recipe
from vehicledyn.studies.sets import Grid, Study

if TYPE_CHECKING:
    from vehicledyn.files.scenario.portable_models import PortableModel
    from vehicledyn.files.scenario.python_models import PythonModel

MOST_STRUCTURES = 64
"""Combinations of choices; each needs equations of its own."""

_SHARED = ("duration", "output", "title", "description", "kinematics", "motion", "model")


@dataclass(frozen=True)
class LoadedStudy:
    """A study that may run: its text, what varies, and the scenario that nothing varies of yet."""

    path: Path
    text: str
    study: Study
    recipe: Recipe
    base: LoadedScenario
    design: Design

    def subjects(self) -> Iterator[LoadedScenario]:
        """Yield its scenario as it is, and with each choice of what is no quantity."""
        yield self.base
        for axis in self.design.axes:
            for number in range(len(axis.choices)):
                change = Change(axis.key, axis.value(number), axis.key)
                loaded, _ = self.recipe.examine([change])
                if loaded is not None:
                    yield loaded

    @cached_property
    def digests(self) -> dict[str, str]:
        """Fingerprints of what decides the results: the study and the scenario with its files."""
        from vehicledyn.studies.digests import study_digests

        return study_digests(self.study, self.base, self.design)


def load_study(path: Path, overrides: Sequence[str] = ()) -> LoadedStudy:
    """Read and validate a study file with its scenario.

    Parameters
    ----------
    path
        YAML file.
    overrides
        Changes ``key=value``: of the study where the key begins with one of its own, such as
        ``cases.number=100``, else of the scenario.

    Raises
    ------
    InputError
        If anything is wrong; one line for each problem, those of the scenario included.
    """
    return study_of(read_yaml(path), path, overrides)


def study_of(
    document: Document,
    path: Path,
    overrides: Sequence[str] = (),
    *,
    documents: dict[str, Document] | None = None,
    built: PythonModel | None = None,
    arguments: Mapping[Place, str] | None = None,
) -> LoadedStudy:
    """Return the study of a document that was read.

    ``documents`` are files that are not read, ``built`` is a model that is no file, ``arguments``
    are the names of what a caller gave in place of values of the document.

    Raises
    ------
    InputError
        As :func:`load_study`.
    """
    if not isinstance(document.data, dict):
        words = f"the file holds {describe(document.data)}; a study is a mapping"
        problem = Problem(document.name, START, "file", f"{words} with title, scenario and cases")
        raise refusal([*document.problems, problem], document.name)
    reading = _Reading(document, path, overrides, documents or {}, _portable(built))
    reading.sources.options.update(arguments or {})
    return reading.load()


def _portable(built: PythonModel | None) -> PortableModel | None:
    if built is None:
        return None
    from vehicledyn.files.scenario.portable_models import PortableModel

    return PortableModel(built)


class _Reading:
    """The steps of reading one study, and the problems they find."""

    def __init__(
        self,
        document: Document,
        path: Path,
        overrides: Sequence[str],
        documents: dict[str, Document],
        built: PortableModel | None,
    ) -> None:
        self.document, self.path, self.documents = document, path, documents
        self.built = built
        self.data, self.sources = copy.deepcopy(document.data), Sources(document)
        self.problems = list(document.problems)
        self.outside: list[Change] = []
        for override in overrides:
            change = read_override(override)
            if isinstance(change, Problem):
                self.problems.append(change)
            elif change.key.partition(".")[0] in Study.model_fields:
                found = apply_change(self.data, change, self.sources)
                self.problems += [found] if found is not None else []
            else:
                self.outside.append(change)

    def load(self) -> LoadedStudy:
        study = self._study()
        columns, problems = read_columns(study, self.path, self.sources)
        self.problems += problems
        scenario, changes = self.path.parent / study.scenario, self._changes(study)
        recipe = Recipe(scenario, changes, (), self.documents, self.built)
        base = self._base(recipe)
        self._check_keys(columns)
        self._refuse()
        axes = [self._axis(column, recipe, base) for column in columns]
        self._refuse()
        design = self._design(study, [axis for axis in axes if axis is not None])
        self._refuse()
        whole = replace(recipe, axes=design.axes)
        return LoadedStudy(self.path, self.document.text, study, whole, base, design)

    def _study(self) -> Study:
        try:
            study = Study.model_validate(self.data)
            self.problems += bare_numbers(self.data, units_of(study), self.sources)
            return study
        except ValidationError as error:
            reported = {(p.mark, p.field) for p in self.problems if p.mark is not None}
            for line in error.errors():
                at_key = line["type"] == UNKNOWN_KEY
                found = self.sources.problem(line["loc"], words_of(line), at_key=at_key)
                self.problems += [found] if (found.mark, found.field) not in reported else []
            raise refusal(self.problems, self.document.name) from None

    def _changes(self, study: Study) -> tuple[Change, ...]:
        changes = [Change(k, v, self._at(("set", k))) for k, v in study.set.items()]
        if study.output.interval is not None:
            place = ("output", "interval")
            interval = f"{study.output.interval!r} s"
            changes.append(Change("output.interval", interval, self._at(place)))
        return (*changes, *self.outside)

    def _base(self, recipe: Recipe) -> LoadedScenario:
        try:
            loaded, problems = recipe.examine()
        except InputError as error:
            problem = self.sources.problem(("scenario",), str(error).splitlines()[0])
            raise refusal([*self.problems, problem], self.document.name) from None
        if loaded is None:
            raise refusal([*self.problems, *problems], self.document.name)
        return loaded

    def _check_keys(self, columns: Sequence[Written]) -> None:
        for column in columns:
            first = column.key.partition(".")[0]
            if first in _SHARED:
                words = f"'{first}' is the same for all cases; change it under 'set'"
                self.problems.append(column.problem(self.sources, None, words))

    def _axis(self, column: Written, recipe: Recipe, base: LoadedScenario) -> Axis | None:
        """Return what a key means; a quantity is one that changes nothing but quantities."""
        unit = self._unit(column, recipe, base)
        if unit is None:
            return None
        if not unit:
            return self._choice(column, recipe)
        try:
            values = array("d", (column.in_si(k, unit) for k in range(len(column.values))))
        except InputError:
            self.problems += self._wrong_values(column, unit)
            return None
        for number in {_lowest(values), _highest(values)}:
            self._try(column, number, quantity_text(values[number], unit), recipe)
        if not column.is_range:
            return Axis(column.key, unit, values)
        low, high = values
        if column.is_log and not (low > 0.0 and high > 0.0):
            words = "a logarithmic scale needs values above zero"
            self.problems.append(column.problem(self.sources, None, words))
            return None
        axis = Axis(column.key, unit, low=low, high=high, is_log=column.is_log)
        return Axis(column.key, unit, _spaced(axis, column.count)) if column.count else axis

    def _unit(self, column: Written, recipe: Recipe, base: LoadedScenario) -> str | None:
        """Return the unit of a key, "" where it is a choice, None where its values are wrong."""
        known = _named(base.resolved)
        for number in dict.fromkeys((*range(min(4, len(column.values))), len(column.values) - 1)):
            value = column.values[number]
            if column.unit and not isinstance(value, str):
                value = f"{value!r} {column.unit}"
            loaded = self._try(column, number, value, recipe)
            if loaded is None:
                return None
            found = _named(loaded.resolved)
            changed = [k for k in {*known, *found} if known.get(k, _NONE) != found.get(k, _NONE)]
            if changed:
                return _unit_of(column.key, loaded, changed, found)
        return _named_unit(column.key, base)

    def _choice(self, column: Written, recipe: Recipe) -> Axis | None:
        if column.is_range:
            words = "is no quantity that can have values between others; give a list"
            self.problems.append(column.problem(self.sources, None, words))
            return None
        texts = [json.dumps(value, sort_keys=True) for value in column.values]
        distinct = {text: number for number, text in reversed(list(enumerate(texts)))}
        numbers = sorted(distinct.values())
        if len(numbers) > MOST_STRUCTURES:
            words = (
                f"{len(numbers)} different values that are no quantities, each with equations of "
                f"its own; {MOST_STRUCTURES} at most"
            )
            self.problems.append(column.problem(self.sources, None, words))
            return None
        for number in numbers:
            self._try(column, number, column.values[number], recipe)
        places = {texts[number]: float(k) for k, number in enumerate(numbers)}
        choices = tuple(column.values[number] for number in numbers)
        return Axis(column.key, "", array("d", (places[t] for t in texts)), choices)

    def _try(
        self, column: Written, number: int, value: Any, recipe: Recipe
    ) -> LoadedScenario | None:
        """Return the scenario with one value of a key, None and a problem if it is refused."""
        origin = str(column.problem(self.sources, number, ""))
        change = Change(column.key, value, origin)
        loaded, problems = recipe.examine([change])
        self.problems += [p for p in problems if p not in self.problems]
        return loaded

    def _wrong_values(self, column: Written, unit: str) -> Iterator[Problem]:
        for number in range(len(column.values)):
            try:
                column.in_si(number, unit)
            except InputError as error:
                yield column.problem(self.sources, number, str(error))

    def _design(self, study: Study, axes: list[Axis]) -> Design:
        cases, keys = study.cases, [axis.key for axis in axes]
        structures = math.prod(len(a.choices) for a in axes if a.is_choice)
        if isinstance(cases, Grid):
            count = math.prod(len(axis.values) for axis in axes)
        else:
            count = getattr(cases, "number", 0) or len(axes[0].values)
            combinations = zip(*(a.values for a in axes if a.is_choice), strict=True)
            structures = len(set(combinations)) if cases.kind == "list" else 1
        if structures > MOST_STRUCTURES:
            words = (
                f"{structures} combinations of values that are no quantities, each with "
                f"equations of its own; {MOST_STRUCTURES} at most"
            )
            self.problems.append(self.sources.problem(("cases",), words, at_key=True))
        if len(set(keys)) < len(keys):
            self.problems.append(self.sources.problem(("cases",), "a key varies twice"))
        return Design(cases.kind, tuple(axes), count, getattr(cases, "seed", 0))  # type: ignore[arg-type]

    def _at(self, place: Place) -> str:
        problem = self.sources.problem(place, "")
        return str(problem._replace(field=dotted(place) if problem.mark else problem.field))

    def _refuse(self) -> None:
        if self.problems:
            raise refusal(self.problems, self.document.name)


_NONE = object()
_INITIAL = "initial."


def leaves(value: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Yield paths and values of plain data."""
    if isinstance(value, dict):
        items = [(str(key), item) for key, item in value.items()]
    elif isinstance(value, list):
        items = [(str(number), item) for number, item in enumerate(value)]
    else:
        yield path, value
        return
    for key, item in items:
        yield from leaves(item, (*path, key))


def _named(data: Any) -> dict[str, Any]:
    return {".".join(path): value for path, value in leaves(data)}


def _whole(name: str) -> str:
    """Return the name of the vector that a component belongs to."""
    return name.rpartition(".")[0]


def _unit_of(key: str, loaded: LoadedScenario, changed: list[str], found: dict[str, Any]) -> str:
    """Return the unit of a key that changes these values; "" unless all are quantities.

    Quantities that are numbers in the equations do not count as such.
    """
    part = getattr(loaded.scenario, key.partition(".")[0], None)
    if getattr(part, "in_equations", False):
        return ""
    named = _named_unit(key, loaded)
    if key.startswith(_INITIAL):
        return named
    units = {loaded.units.get(k) or loaded.units.get(_whole(k)) for k in changed}
    if None in units or not all(isinstance(found.get(name), float) for name in changed):
        return ""
    return named or (str(units.pop()) if len(units) == 1 else "")


def _named_unit(key: str, loaded: LoadedScenario) -> str:
    """Return the unit of the quantity that a key names itself, "" if it is none."""
    if key.startswith(_INITIAL):
        return _start_unit(key.removeprefix(_INITIAL), loaded)
    names = (key, _whole(key), f"parameters.{key}", f"parameters.{_whole(key)}")
    return next((loaded.units[name] for name in names if name in loaded.units), "")


def _start_unit(name: str, loaded: LoadedScenario) -> str:
    """Return the unit of a coordinate's start, or of a rate's."""
    known = getattr(loaded.written, "coordinates", {})
    if name in known:
        return str(known[name].unit)
    coordinate = known.get(name.removesuffix("_rate"))
    return "" if coordinate is None else f"{coordinate.unit}/s"


def _spaced(axis: Axis, count: int) -> array[float]:
    low, high, steps = axis.low, axis.high, max(1, count - 1)
    if axis.is_log:
        inner = [low * (high / low) ** (k / steps) for k in range(count)]
    else:
        inner = [low + (high - low) * k / steps for k in range(count)]
    if count > 1:
        inner[-1] = high
    return array("d", inner)


def _lowest(values: array[float]) -> int:
    return min(range(len(values)), key=values.__getitem__)


def _highest(values: array[float]) -> int:
    return max(range(len(values)), key=values.__getitem__)
