"""Studies of optimal manoeuvres as files: controls, objective, conditions, limits, path."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import kinds
from vehicledyn.base.units import with_unit
from vehicledyn.base.yaml import Document
from vehicledyn.files.scenario import load_model
from vehicledyn.files.scenario.settings import override_texts
from vehicledyn.files.scenario.target import Target
from vehicledyn.library import locate
from vehicledyn.studies.manoeuvre_optimisation.path_file import PathTable, read_path
from vehicledyn.studies.study_form import StudyForm, is_there

_REQUIRED = ("controls", "minimise", "duration")
_OPTIONAL = ("title", "model", "scenario", "speed", "set", "start", "end", "limits", "path")
_MORE = ("periodic", "intervals", "refinements", "accuracy", "tolerance", "most_iterations", "step")
_CONTROL = ("input", "from", "to", "rate", "acceleration")
_RANGE = ("from", "to", "guess")
_MOST_INTERVALS = 1000  # of the first mesh; preparing the derivatives of 4000 takes minutes


@dataclass(frozen=True)
class ControlText:
    """A control as written: inputs with factors, bounds as texts or numbers."""

    name: str
    inputs: dict[str, float]
    low: Any
    high: Any
    rate: Any = None
    acceleration: Any = None


@dataclass(frozen=True)
class ManoeuvreStudy:
    """What is to be optimised, as written.

    ``start``, ``end`` and ``limits`` map names to a value, to "free" or to a mapping with from and
    to; ``terms`` of the objective to weights; ``periodic`` names or patterns of states to what
    they gain in a cycle. ``step`` is that of the check [s], None for what is usual.
    """

    path: Path
    document: Document
    title: str
    target: Target
    speed: float | None
    controls: tuple[ControlText, ...]
    terms: dict[str, float]
    duration: Any
    start: dict[str, Any]
    end: dict[str, Any]
    limits: dict[str, Any]
    track: PathTable | None
    periodic: dict[str, Any]
    intervals: int
    refinements: int
    accuracy: float
    tolerance: float
    most_iterations: int
    step: float | None

    @property
    def text(self) -> str:
        """The file as it is written."""
        return self.document.text

    def subjects(self) -> list[Target]:
        """Return its model or scenario."""
        return [self.target]


def load_manoeuvre(path: Path, overrides: Sequence[str] = ()) -> ManoeuvreStudy:
    """Read and validate a study of an optimal manoeuvre.

    Parameters
    ----------
    path
        YAML file.
    overrides
        Changes ``key=value`` of its model or scenario.

    Raises
    ------
    InputError
        If anything is wrong; all problems of the file's form are listed.
    """
    form = StudyForm.read(path, required=_REQUIRED, optional=(*_OPTIONAL, *_MORE))
    data = form.data
    controls = _controls(form)
    terms = _terms(form)
    _check_ranges(form)
    numbers = {
        "intervals": form.number("intervals", 20, least=2, most=_MOST_INTERVALS, whole=True),
        "refinements": form.number("refinements", 4, least=0, whole=True),
        "accuracy": form.number("accuracy", 1e-6, least=0.0),
        "tolerance": form.number("tolerance", 1e-8, least=0.0),
        "most_iterations": form.number("most_iterations", 500, least=1, whole=True),
    }
    if numbers["tolerance"] == 0.0:
        form.wrong(("tolerance",), "must be above zero")
    step, speed = _quantity(form, "step", "s", None), _quantity(form, "speed", "m/s", None)
    if step is not None and step <= 0.0:
        form.wrong(("step",), "must be above zero")
    if ("model" in data) == ("scenario" in data):
        form.wrong((), "give either a model or a scenario")
    form.refuse()
    target = _target(form, overrides)
    track = None if "path" not in data else read_path(form, data["path"], target)
    form.refuse()
    return ManoeuvreStudy(
        path,
        form.document,
        str(data.get("title", path.stem)),
        target,
        speed,
        controls,
        terms,
        data["duration"],
        _mapping(data, "start"),
        _ends(form, track),
        _mapping(data, "limits"),
        track,
        _periodic(data.get("periodic")),
        int(numbers["intervals"]),
        int(numbers["refinements"]),
        numbers["accuracy"],
        numbers["tolerance"],
        int(numbers["most_iterations"]),
        step,
    )


def _mapping(data: dict[str, Any], key: str) -> dict[str, Any]:
    return dict(data.get(key) or {})


def _ends(form: StudyForm, track: PathTable | None) -> dict[str, Any]:
    """Return what holds at the end, with the distance to the end of the path or of a lap."""
    ends, start = _mapping(form.data, "end"), _mapping(form.data, "start").get("path.distance", 0.0)
    if track is not None and ends.get("path.distance") == "end":
        begin = 0.0
        if track.closed and not isinstance(start, dict) and start != "free":
            with suppress(InputError):  # of what is told with the start
                begin = with_unit(start, "m")
        ends["path.distance"] = f"{begin + track.length!r} m"
    return ends


def _target(form: StudyForm, overrides: Sequence[str]) -> Target:
    """Return the model or scenario of the study, with its changes."""
    data, folder = form.data, form.path.parent
    key = "model" if "model" in data else "scenario"
    given = data[key]
    if not isinstance(given, str):
        form.wrong((key,), "expected a path or name")
        form.refuse()
    changes = data.get("set")
    if changes is not None and not isinstance(changes, dict):
        form.wrong(("set",), "expected a mapping of changes")
        form.refuse()
    texts = [*override_texts(changes or {}, {}), *overrides]
    if key == "scenario":
        return form.only_scenario((key,), given, changes, overrides)
    for place in (folder / given, folder / f"{given}.yaml"):
        if is_there(place):
            return load_model(str(place), texts)
    if given in kinds("model"):
        return load_model(given, texts)
    return load_model(str(locate(given, ("system",), kinds("model"))), texts)


def _controls(form: StudyForm) -> tuple[ControlText, ...]:
    found = []
    for name, item in form.entries(("controls",), _CONTROL, ("from", "to")):
        given = item.get("input", name)
        inputs = {given: 1.0} if isinstance(given, str) else given
        if isinstance(inputs, list):
            inputs = {str(entry): 1.0 for entry in inputs}
        inputs = inputs if isinstance(inputs, dict) else {}
        factors = list(inputs.values())
        place = "controls", name, "input"
        if not factors or not all(_is_number(factor) for factor in factors):
            form.wrong(place, "expected an input, or inputs with factors")
            continue
        if not all(factors) or not np.isfinite(factors).all():
            form.wrong(place, "its factors must be finite and not zero")
            continue
        bounds = (item["from"], item["to"], item.get("rate"), item.get("acceleration"))
        found.append(ControlText(name, {str(k): float(v) for k, v in inputs.items()}, *bounds))
    return tuple(found)


def _terms(form: StudyForm) -> dict[str, float]:
    given = form.data.get("minimise")
    terms = {given: 1.0} if isinstance(given, str) else given
    terms = terms if isinstance(terms, dict) else {}
    weights = list(terms.values())
    if not weights or not all(_is_number(weight) for weight in weights):
        if given not in (None, {}, ""):
            form.wrong(("minimise",), "expected a term, or terms with weights that are numbers")
        return {}
    for name, weight in terms.items():
        if not np.isfinite(weight):
            form.wrong(("minimise", name), "the weight must be finite")
    if not any(weights):
        form.wrong(("minimise",), "all weights are zero, so that no motion is better than another")
    return {str(name): float(weight) for name, weight in terms.items()}


def _check_ranges(form: StudyForm) -> None:
    """Note conditions that are no value and no range."""
    duration = form.data.get("duration")
    if isinstance(duration, dict):
        form.check(("duration",), duration, _RANGE)
    for group in ("start", "end", "limits"):
        items = form.data.get(group) or {}
        if not isinstance(items, dict):
            form.wrong((group,), "expected a mapping of names to values")
            form.refuse()
        for name, item in items.items():
            if isinstance(item, dict):
                form.check((group, name), item, ("from", "to"))
            elif group == "limits":
                form.wrong((group, name), "expected a mapping with from, to")
    periodic = form.data.get("periodic")
    if periodic is not None and not isinstance(periodic, dict | list | bool):
        form.wrong(("periodic",), "expected true, a list of states, or states with what they gain")


def _periodic(given: Any) -> dict[str, Any]:
    if isinstance(given, bool) or given is None:
        return {"*": 0.0} if given else {}
    return dict(given) if isinstance(given, dict) else {str(name): 0.0 for name in given}


def _quantity(form: StudyForm, key: str, unit: str, default: float | None) -> float | None:
    if key not in form.data:
        return default
    try:
        value = with_unit(form.data[key], unit)
    except InputError as error:
        form.wrong((key,), str(error))
        return default
    if not np.isfinite(value):
        form.wrong((key,), "must be finite")
    return value


def _is_number(given: Any) -> bool:
    return isinstance(given, int | float) and not isinstance(given, bool)
