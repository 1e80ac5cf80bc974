"""From a scenario file to a validated, resolved run; every problem of it is reported at once."""

from __future__ import annotations

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import ValidationError

from vehicledyn.base.errors import InputError, unknown_name
from vehicledyn.base.files.limits import UnreadableFileError, check_regular
from vehicledyn.base.parameters import as_plain, field_unit, units_of
from vehicledyn.base.problems import START, Place, Problem, refusal
from vehicledyn.base.registry import find, kinds
from vehicledyn.base.units import describe
from vehicledyn.base.validation_messages import UNKNOWN_KEY, words_of
from vehicledyn.base.yaml import Document, copied, parse_yaml, read_yaml
from vehicledyn.files.scenario.bare_numbers import bare_numbers
from vehicledyn.files.scenario.catalogue_models import CatalogueModel
from vehicledyn.files.scenario.checks import check_times, named_coordinates, refused_tyres
from vehicledyn.files.scenario.model_names import is_written, known_models, system_path
from vehicledyn.files.scenario.overrides import Change, apply_change, apply_override
from vehicledyn.files.scenario.referenced_files import beside
from vehicledyn.files.scenario.sets import Scenario
from vehicledyn.files.scenario.sources import Sources
from vehicledyn.files.scenario.system_models import (
    WrittenModel,
    is_system,
    parameter_groups,
    read_model,
    unsuitable,
)
from vehicledyn.files.scenario.target import Target
from vehicledyn.files.scenario.titles import changed_title

if TYPE_CHECKING:
    from vehicledyn.files.scenario.python_models import PythonModel


@dataclass(frozen=True, repr=False)
class LoadedScenario(Target):
    """A scenario that may run.

    ``text`` is the file as read, ``overrides`` what changed it, ``written`` the model with its
    parameters. ``resolved`` is everything used, as plain mappings, lists and SI numbers, ``units``
    the unit of each quantity in it by dotted name; ``built`` the model built in Python, unchanged.
    """

    path: Path
    text: str
    overrides: tuple[str, ...]
    scenario: Scenario
    resolved: dict[str, Any]
    units: dict[str, str]
    written: WrittenModel
    built: PythonModel | None = None

    @property
    def title(self) -> str:
        """Title of its runs: that of the file, and what was changed."""
        return changed_title(self.scenario.title or self.model_name, self.overrides)

    @property
    def choices(self) -> Scenario:
        """What it chooses."""
        return self.scenario

    @property
    def asks_for_outputs(self) -> bool:
        """Whether it names channels or figures; whoever names none gets all."""
        output = self.scenario.output
        return output.channels is not None or bool(output.plots)

    @property
    def model_name(self) -> str:
        """Name of its model."""
        return self.scenario.model

    @property
    def origin(self) -> Path:
        """Its file."""
        return self.path

    @property
    def file_stem(self) -> str:
        """Name of its file, without suffix."""
        return self.path.stem

    def with_overrides(
        self, overrides: Sequence[str], *, first: Sequence[str] = ()
    ) -> LoadedScenario:
        """Return it with further changes; its file is not read again."""
        document = parse_yaml(self.text, str(self.path))
        changes = (*first, *self.overrides, *overrides)
        changed, problems = examine_scenario(document, self.path, changes, built=self.built)
        if changed is None:
            raise refusal(problems, document.name)
        return changed

    def __repr__(self) -> str:
        """Return title, file and changes."""
        return _shown("Scenario", f"{self.scenario.title!r} ({self.path})", self.overrides)


def load_scenario(path: Path, overrides: Sequence[str] = ()) -> LoadedScenario:
    """Read, validate and resolve a scenario file.

    Parameters
    ----------
    path
        YAML file.
    overrides
        Changes ``key=value`` with dotted keys, applied in order; ``parameters.`` may be left
        out before a parameter of the model.

    Raises
    ------
    InputError
        If anything is wrong; the text has one line ``file:line:column: field: message`` for
        each problem of the file and ``key: message`` for each of the overrides.
    """
    document = read_yaml(path)
    loaded, problems = examine_scenario(document, path, overrides)
    if loaded is None:
        raise refusal(problems, document.name)
    return loaded


def examine_scenario(
    document: Document,
    path: Path,
    overrides: Sequence[str] = (),
    changes: Sequence[Change] = (),
    built: PythonModel | None = None,
) -> tuple[LoadedScenario | None, list[Problem]]:
    """Return the scenario of a document that was read, or None, and all that is wrong with it.

    Parameters
    ----------
    document
        Content of the file.
    path
        The file; models are looked for beside it.
    overrides
        Changes as texts, see :func:`load_scenario`.
    changes
        Further changes, made after them.
    built
        The model, where it was built in Python.
    """
    problems = [*document.problems, *_check_top(document)]
    if not isinstance(document.data, dict) or is_system(document.data):
        return None, problems
    data, sources = copied(document.data), Sources(document)
    groups = _parameter_groups(data.get("model"), path, built) if overrides or changes else set()
    found = [apply_override(data, override, sources, groups) for override in overrides]
    found += [apply_change(data, change, sources, groups) for change in changes]
    problems += [problem for problem in found if problem is not None]
    scenario, wrong = _read_scenario(data, sources)
    written, wrong_model = (
        built.changed(data, sources) if built else _read_written(data, path, sources)
    )
    problems += _not_yet_reported(problems, wrong) + wrong_model
    problems += _not_yet_reported(problems, unsuitable(data, written, sources))
    if scenario is not None:
        wrong_beside = [*beside(scenario, path.parent), *_motion_beside(scenario, path.parent)]
        wrong_beside = wrong_beside or refused_tyres(scenario, path.parent)
        wrong_beside += named_coordinates(scenario, {} if written is None else written.coordinates)
        problems += [sources.problem(place, words) for place, words in wrong_beside]
    units = _units_of_sections(data) if scenario is None else units_of(scenario)
    if written is not None:
        units |= {f"parameters.{name}": unit for name, unit in written.units.items()}
    start = {} if written is None else _start_units(written)
    bare = bare_numbers(data, {**units, **start}, sources)
    for new in (bare, check_times(data, scenario, sources)):
        places = {problem[:3] for problem in problems}
        problems += [problem for problem in new if problem[:3] not in places]
    if problems or scenario is None or written is None:
        return None, problems
    resolved = as_plain(scenario) | written.described
    return (
        LoadedScenario(
            path,
            document.text,
            tuple(overrides),
            scenario,
            resolved,
            units,
            written,
            built,
        ),
        problems,
    )


@dataclass(frozen=True, repr=False)
class LoadedModel(Target):
    """A model on its own: a vehicle of the catalogue with its parameters, or a system file.

    ``overrides`` are what changed the values of its file.
    """

    name: str
    written: WrittenModel
    overrides: tuple[str, ...] = ()
    built: PythonModel | None = None
    text: str = ""
    resolved: dict[str, Any] = field(default_factory=dict)

    @property
    def choices(self) -> None:
        """None: nothing is chosen."""
        return

    @property
    def title(self) -> str:
        """Its name and what was changed."""
        return changed_title(self.file_stem, self.overrides)

    @property
    def model_name(self) -> str:
        """Its name."""
        return self.name

    @property
    def origin(self) -> Path:
        """Its name."""
        return Path(self.name)

    @property
    def file_stem(self) -> str:
        """Its name, without suffix."""
        return Path(self.name).stem

    def with_overrides(self, overrides: Sequence[str], *, first: Sequence[str] = ()) -> LoadedModel:
        """Return it with further changes."""
        name = self.name if self.written.file is None else str(self.written.path)
        return load_model(name, (*first, *self.overrides, *overrides), self.built)

    def __repr__(self) -> str:
        """Return name and changes."""
        return _shown("Model", self.name, self.overrides)


def load_model(
    name: str, overrides: Sequence[str] = (), built: PythonModel | None = None
) -> LoadedModel:
    """Return a vehicle of the catalogue or a system file with changes of its parameters.

    Parameters
    ----------
    name
        Name of a model of the catalogue or the library, or the path of a system file.
    overrides
        Changes ``parameters.key=value``, or short ``key=value``, applied in order; of a system
        file also ``initial.coordinate=value``.
    built
        The model, where it was built in Python.

    Raises
    ------
    InputError
        If there is no such model or a change is wrong; one line for each problem.
    """
    in_file = built is not None or is_written(name)
    if not in_file and name not in kinds("model"):
        raise InputError(unknown_name("model", name, known_models()))
    sources = Sources(Document(name, ""))
    data: dict[str, Any] = {"parameters": {}, **({"initial": {}} if in_file else {})}
    may_change = tuple(data)
    groups = _parameter_groups(name, Path("-"), built) if overrides else set()
    found = (apply_override(data, override, sources, groups) for override in overrides)
    problems = [problem for problem in found if problem is not None]
    words = "only 'parameters' of a model can be set; give a scenario to change more"
    problems += [sources.problem((key,), words) for key in data if key not in may_change]
    written: WrittenModel | None
    if built is not None:
        written, wrong = built.changed(data, sources)
    elif in_file:
        written, wrong = read_model(system_path(name, Path()), data, sources)
    else:
        written, wrong = CatalogueModel.read(name, data["parameters"], sources)
    units = {f"parameters.{key}": unit for key, unit in written.units.items()} if written else {}
    bare = bare_numbers(data, {**units, **_start_units(written)}, sources)
    if problems or wrong or bare or written is None:
        raise refusal(problems + wrong + bare, name)
    return LoadedModel(written.name, written, tuple(overrides), built)


def _shown(what: str, name: str, overrides: Sequence[str]) -> str:
    changed = f" with {', '.join(overrides)}" if overrides else ""
    return f"{what} {name}{changed}"


def is_system_file(path: Path) -> bool:
    """Return whether a file holds a system rather than a scenario.

    Raises
    ------
    InputError
        If the file cannot be read or is no YAML.
    """
    return is_system(read_yaml(path).data)


def _parameter_groups(model: Any, path: Path, built: PythonModel | None) -> set[str]:
    """Return the first words of a model's parameters that no scenario field has."""
    if built is not None:
        return built.groups
    if isinstance(model, str) and model in kinds("model"):
        groups = set(find("model", model).parameter_class.model_fields)
    elif is_written(model) and system_path(model, path.parent).is_file():
        groups = parameter_groups(system_path(model, path.parent))
    else:
        groups = set()
    return groups - set(Scenario.model_fields)


def _read_written(
    data: dict[str, Any], path: Path, sources: Sources
) -> tuple[WrittenModel | None, list[Problem]]:
    model = data.get("model")
    if isinstance(model, str) and model in kinds("model"):
        changes = data.get("parameters") or {}
        is_plain = isinstance(changes, dict)
        return CatalogueModel.read(model, changes, sources) if is_plain else (None, [])
    if not is_written(model):
        return None, []
    file = system_path(str(model), path.parent)
    try:
        check_regular(file)
    except UnreadableFileError as error:
        return None, [sources.problem(("model",), str(error))]
    return read_model(file, data, sources)


def _start_units(written: WrittenModel | None) -> dict[str, str]:
    """Return the units of start values and rates, by their dotted names in a scenario."""
    found = {} if written is None else written.coordinates
    units = {name: coordinate.unit for name, coordinate in found.items()}
    rates = {f"{name}_rate": f"{unit}/s" for name, unit in units.items()}
    return {f"initial.{name}": unit for name, unit in {**rates, **units}.items()}


def _motion_beside(scenario: Scenario, folder: Path) -> list[tuple[Place, str]]:
    """Return what is wrong with the file of a motion, if the scenario names one."""
    if not isinstance(scenario.motion, str):
        return []
    try:
        check_regular(folder / scenario.motion)
    except UnreadableFileError as error:
        return [(("motion",), str(error))]
    return []


def _check_top(document: Document) -> list[Problem]:
    if is_system(document.data):
        words = "this is a system; name it in a scenario as 'model: {}', with duration and solver"
        return [Problem(document.name, START, "file", words.format(Path(document.name).name))]
    if isinstance(document.data, dict):
        return []
    empty = document.data is None and not document.problems
    words = "the file is empty" if empty else f"the file holds {describe(document.data)}"
    text = f"{words}; a scenario is a mapping with title, model, manoeuvre and so on"
    return [Problem(document.name, START, "file", text)]


def _not_yet_reported(reported: list[Problem], new: list[Problem]) -> list[Problem]:
    """Return the new problems but for those at a place where one is reported already."""
    places = {(problem.mark, problem.field) for problem in reported if problem.mark is not None}
    return [problem for problem in new if (problem.mark, problem.field) not in places]


def _units_of_sections(data: dict[str, Any]) -> dict[str, str]:
    """Return the units of the sections that can be read where others cannot, by dotted name."""
    units: dict[str, str] = {}
    nothing: dict[str, Any] = {}
    for name in Scenario.model_fields:
        unit = field_unit(Scenario, name)
        if unit is not None:
            units[name] = unit
        elif name in data:
            blank = Scenario.model_construct(**nothing)
            with contextlib.suppress(ValidationError):
                Scenario.__pydantic_validator__.validate_assignment(blank, name, data[name])
                units |= units_of(getattr(blank, name), f"{name}.")
    return units


def _read_scenario(data: dict[str, Any], sources: Sources) -> tuple[Scenario | None, list[Problem]]:
    try:
        return Scenario.model_validate(data), []
    except ValidationError as error:
        return None, [
            sources.problem(line["loc"], words_of(line), at_key=line["type"] == UNKNOWN_KEY)
            for line in error.errors()
        ]
