"""What analyses are asked about: a file, a name, a system in Python or what was loaded before."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeAlias

import vehicledyn.catalogue  # noqa: F401
from vehicledyn.base.problems import refusal
from vehicledyn.base.registry import kinds
from vehicledyn.base.yaml import parse_yaml, read_yaml
from vehicledyn.files.scenario import (
    LoadedModel,
    LoadedScenario,
    load_model,
    load_scenario,
)
from vehicledyn.files.scenario.load import examine_scenario
from vehicledyn.files.scenario.python_models import PythonModel
from vehicledyn.files.scenario.sets import Scenario
from vehicledyn.files.scenario.system_models import is_system
from vehicledyn.library import Kind, locate
from vehicledyn.multibody.model.system import System

Source: TypeAlias = str | Path | System | LoadedScenario | LoadedModel
"""Path or name of a scenario or model, a system built in Python, or what was loaded."""

Target: TypeAlias = LoadedScenario | LoadedModel

USUAL_RUN: dict[str, Any] = {
    "duration": "10 s",
    "solver": {"kind": "dop853", "relative_tolerance": 1e-8, "absolute_tolerance": 1e-8},
    "output": {"interval": "10 ms"},
}
"""How long and by what method a model is simulated of which nothing else is said."""

_OF_MODELS = {"model", "parameters", "initial"}

_DRIVEN: dict[str, Any] = {
    "manoeuvre": {"kind": "straight"},
    "speed": "20 m/s",
    "solver": {"kind": "rk4"},
}


def read_target(
    source: Source,
    overrides: Sequence[str] = (),
    preferred: tuple[Kind, Kind] = ("system", "scenario"),
) -> Target:
    """Return the scenario or model that is meant, with changes.

    Parameters
    ----------
    source
        What is meant.
    overrides
        Changes ``key=value``.
    preferred
        Which of a system and a scenario of the library is meant where both have the name.

    Raises
    ------
    InputError
        If there is none, or something is wrong with it or with a change.
    """
    return _read(source, preferred, of_scenario=overrides, of_model=overrides)


def _read(
    source: Source,
    preferred: tuple[Kind, Kind],
    *,
    of_scenario: Sequence[str],
    of_model: Sequence[str] = (),
) -> Target:
    """Return what is meant, with the changes of what it is."""
    if isinstance(source, Target):
        changes = of_model if source.choices is None else of_scenario
        return source.with_overrides(changes) if changes else source
    if isinstance(source, System):
        return _of_system(source, of_model)
    if source in kinds("model") and not Path(f"{source}.yaml").is_file():
        return load_model(str(source), of_model)
    path = locate(str(source), preferred, kinds("model"))
    if is_system(read_yaml(path).data):
        return load_model(str(path), of_model)
    return load_scenario(path, of_scenario)


def read_scenario(source: Source, overrides: Sequence[str] = ()) -> LoadedScenario:
    """Return the scenario that is meant, with changes; of a model its usual run.

    Raises
    ------
    InputError
        As :func:`read_target`, and if a model cannot run without more being said.
    """
    target = _read(source, ("scenario", "system"), of_scenario=overrides)
    if target.choices is not None:
        return target
    name = target.model_name
    data = {"title": name, "model": _model_name(target), **USUAL_RUN, **_usual_of(target)}
    document = parse_yaml(_as_text(data), name)
    path = Path.cwd() / f"{name}.yaml"
    changes = [*target.overrides, *overrides]
    loaded, problems = examine_scenario(document, path, changes, built=target.built)
    if loaded is None:
        raise refusal(problems, name)
    return loaded


def read_described(source: Source, overrides: Sequence[str] = ()) -> Target:
    """Return a scenario or model to describe, with changes of whatever a run would let change.

    Where they change more than parameters and starts of a model, such as its tyres, the usual run
    of the model is described.

    Raises
    ------
    InputError
        As :func:`read_scenario`.
    """
    target = read_target(source)
    words = {override.partition("=")[0].strip().partition(".")[0] for override in overrides}
    chosen = words & (set(Scenario.model_fields) - _OF_MODELS)
    if target.choices is None and chosen:
        return read_scenario(target, overrides)
    return target.with_overrides(overrides) if overrides else target


def _model_name(model: Target) -> str:
    """Return what a scenario in any folder names a model by."""
    return model.written.reference


def _of_system(system: System, overrides: Sequence[str]) -> LoadedModel:
    system.check()
    model = PythonModel(system)
    return LoadedModel(model.name, model, built=model).with_overrides(overrides)


def _usual_of(model: Target) -> dict[str, Any]:
    """Return what a vehicle needs besides to drive straight ahead."""
    written = model.written
    if not written.is_vehicle:
        return {"solver": {"kind": "rk4"}} if written.has_wheels else {}
    usual: dict[str, Any] = {**_DRIVEN, "road": {"kind": "flat"}, "wheel_spin": "free"}
    if written.usual_tyre:
        usual["tyres"] = {"kind": written.usual_tyre}
    return usual


def _as_text(data: dict[str, Any]) -> str:
    from vehicledyn.files.building.write import dump

    return dump(data)
