"""Models that are system files: how a scenario reads them and what goes with them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol

from vehicledyn.base.problems import Problem
from vehicledyn.base.registry import find, kinds
from vehicledyn.files.scenario.model_names import is_written
from vehicledyn.files.scenario.sets import Scenario
from vehicledyn.files.scenario.sources import Sources

_FAMILY = "model_file"
_ON_WHEELS = ("tyres", "road", "contact", "relaxation", "wheel_spin", "speed")
_ON_RAILS = ("creep", "rail_contact")
_IN_MANOEUVRES = ("manoeuvre", "speed")


class HasUnit(Protocol):
    """Something that has a unit."""

    @property
    def unit(self) -> str:
        """SI unit."""


class WrittenModel(Protocol):
    """What a scenario needs to know of a model, whether file, Python or the catalogue says it."""

    @property
    def kind(self) -> str:
        """Kind of its builder, "system", "python" or "catalogue"."""

    @property
    def path(self) -> Path:
        """The file."""

    @property
    def text(self) -> str:
        """Its text."""

    @property
    def name(self) -> str:
        """Name of the model."""

    @property
    def has_wheels(self) -> bool:
        """Whether it needs a road and tyres."""

    @property
    def has_rail_wheels(self) -> bool:
        """Whether it needs a track, a creep law and a model of contact."""

    @property
    def is_vehicle(self) -> bool:
        """Whether it can drive a manoeuvre."""

    @property
    def needs_track(self) -> bool:
        """Whether it runs on rails."""

    @property
    def has_track(self) -> bool:
        """Whether its file says on which track."""

    @property
    def title(self) -> str:
        """What it is, in a sentence; empty where nothing says it."""

    @property
    def reference(self) -> str:
        """What a scenario in any folder names it by."""

    @property
    def file(self) -> Any:
        """The sections of its system file, None where it has none."""

    @property
    def places(self) -> Mapping[str, Problem]:
        """Lines of coordinates, parts and bodies in its file by name, without a message."""

    @property
    def motion(self) -> dict[str, Any]:
        """Laws that the scenario gives for inverse dynamics, by coordinate."""

    @property
    def assemblies(self) -> tuple[Any, ...]:
        """Systems that it is made of."""

    @property
    def resolved(self) -> dict[str, Any]:
        """Parameters in SI by name."""

    @property
    def described(self) -> dict[str, Any]:
        """What a resolved scenario holds of it."""

    @property
    def usual_tyre(self) -> str:
        """Kind of the tyre that it has if a scenario says none; empty where its file says it."""

    @property
    def classes(self) -> tuple[type, ...]:
        """Classes that make it, further ones than those of the program."""

    @property
    def units(self) -> dict[str, str]:
        """Unit of each parameter."""

    @property
    def coordinates(self) -> Mapping[str, HasUnit]:
        """What has a unit, by the names of the coordinates."""


def is_system(data: Any) -> bool:
    """Return whether a file's data is a system, not a scenario."""
    return any(find(_FAMILY, kind).is_one(data) for kind in kinds(_FAMILY))


def read_model(
    path: Path, given: dict[str, Any], sources: Sources
) -> tuple[WrittenModel | None, list[Problem]]:
    """Return the model of a file, or None, and all that is wrong with it.

    Parameters
    ----------
    path
        The file.
    given
        What the scenario changes, under "parameters" and "initial".
    sources
        Where the scenario's values came from.

    Raises
    ------
    InputError
        If the file cannot be read or is no YAML.
    """
    model, problems = find(_FAMILY, "system").read(path, given, sources)
    return model, problems


def parameter_groups(path: Path) -> set[str]:
    """Return the first words of a file's parameters."""
    groups: set[str] = find(_FAMILY, "system").groups(path)
    return groups


def unsuitable(data: dict[str, Any], model: WrittenModel | None, sources: Sources) -> list[Problem]:
    """Return what a scenario lacks for its model, and what does not go with it.

    ``model`` is that of the file the scenario names; None for a vehicle of the catalogue.
    """
    if not is_written(data.get("model")):
        wrong = _lacking(data, (*_IN_MANOEUVRES, *needs_of(data.get("model"))))
        if data.get("initial"):
            wrong["initial"] = "only for system files; a vehicle starts straight ahead"
        if data.get("track") is not None:
            wrong["track"] = "only for system files that run on rails; leave this out"
    elif model is None:
        return []
    elif model.is_vehicle:
        wrong = _lacking(data, _IN_MANOEUVRES)
    else:
        wheels = () if model.has_wheels else _ON_WHEELS
        wrong = {key: _wheelless(model, key) for key in wheels if data.get(key) is not None}
        rails = () if model.has_rail_wheels else _ON_RAILS
        text = f"{model.path.name} has no 'rail_wheels'; leave this out"
        wrong |= {key: text for key in rails if data.get(key) is not None}
        if data.get("manoeuvre") is not None:
            wrong["manoeuvre"] = f"{model.path.name} has no section 'vehicle'; leave this out"
        if data.get("start") == "steady":
            wrong["start"] = "'steady' is for vehicles; take 'nominal' or 'static'"
    if model is not None:
        wrong |= _wrong_track(data, model)
    return [
        sources.problem((key,), words, at_key=data.get(key) is not None)
        for key, words in wrong.items()
    ]


def _wheelless(model: WrittenModel, key: str) -> str:
    own = f"its own is 'parameters.{key}'" if key in model.resolved else "leave this out"
    return f"{model.path.name} has no wheels on a road; {own}"


def _wrong_track(data: dict[str, Any], model: WrittenModel) -> dict[str, str]:
    given = data.get("track") is not None
    if given and not model.needs_track:
        return {"track": f"{model.path.name} has nothing that runs on rails; leave this out"}
    if not given and model.needs_track and not model.has_track:
        text = f"{model.path.name} runs on rails; give it a track, such as 'kind: straight'"
        return {"track": f"missing: {text}"}
    return {}


def needs_of(model: Any) -> tuple[str, ...]:
    """Return the further keys of a scenario that a vehicle of the catalogue cannot do without."""
    if model not in kinds("model"):
        return ()
    needs: tuple[str, ...] = getattr(find("model", str(model)), "needs", ())
    return needs


def _lacking(data: dict[str, Any], needed: tuple[str, ...]) -> dict[str, str]:
    wrong = {}
    for key in needed:
        if data.get(key) is None:
            unit = ", in m/s" if key == "speed" else ""
            wrong[key] = f"missing: {Scenario.model_fields[key].description}{unit}"
    return wrong
