"""The model of a study of an optimal manoeuvre, with its controls, as a problem to solve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.optimal_control.problem import (
    BEND,
    POINTS,
    RAMP,
    BoundedExpression,
    Control,
    ControlProblem,
    Corridor,
)
from vehicledyn.analyses.linear.input_names import ModelInput
from vehicledyn.analyses.linear.linear_inputs import Excited
from vehicledyn.analyses.preparation.own_speed import at_speed
from vehicledyn.analyses.preparation.prepare import AssembledPoint, prepare, start_point
from vehicledyn.analyses.preparation.prepared import Prepared, Progress
from vehicledyn.analyses.preparation.runnable import Subject
from vehicledyn.base.argument_names import PythonNaming, arguments_named
from vehicledyn.base.errors import InputError, errors_of, unknown_name
from vehicledyn.base.units import with_unit
from vehicledyn.studies.manoeuvre_optimisation.file import ControlText, ManoeuvreStudy
from vehicledyn.studies.manoeuvre_optimisation.names import PATH, Names, bounds_of
from vehicledyn.studies.manoeuvre_optimisation.path_file import BEYOND, PathTable
from vehicledyn.studies.mistakes import Mistakes
from vehicledyn.symbolic import ops

Floats = NDArray[np.float64]
_FREE = (-np.inf, np.inf)

_LITTLE = 0.01
"""Part of an open path by which a motion may end behind it, as lengths are rounded."""


@dataclass(frozen=True)
class _AsWritten(PythonNaming):
    """Names an input as the study does."""

    def given(self, name: str, value: Any) -> str:
        """Return the input."""
        return str(value)


@dataclass(frozen=True)
class PreparedManoeuvre:
    """A study with its compiled model, the point it starts from and the problem to solve."""

    study: ManoeuvreStudy
    prepared: Prepared
    point: AssembledPoint
    problem: ControlProblem
    speed: float


def prepare_manoeuvre(study: ManoeuvreStudy, progress: Progress) -> PreparedManoeuvre:
    """Return a study ready to be solved.

    Raises
    ------
    InputError
        If a control, a name or a bound means nothing in the model.
    NumericalError
        If the model has no such start.
    """
    target, speed = at_speed(study.target, study.speed)
    scenario = target.choices
    wanted = speed if speed is not None else (scenario.speed or 0.0 if scenario else 0.0)
    taken: list[Excited] = []

    def excite(subject: Subject) -> Subject:
        excited, mistakes = Excited(subject), Mistakes(study.document)
        for control in study.controls:
            for name in control.inputs:
                place = "controls", control.name, "input"
                with mistakes.at(*place), arguments_named(_AsWritten()):
                    excited.add(name)
        mistakes.refuse()
        taken.append(excited)
        return excited.subject

    with errors_of(study.path):
        prepared = prepare(
            target, backend="auto", progress=progress, change=excite, varies_states=True,
            evaluations=1e5,
        )  # fmt: skip
        progress("finding the start", None)
        point = start_point(prepared, wanted, scenario.start if scenario else None)
        problem = _problem(study, prepared, point, taken[0].inputs)
    return PreparedManoeuvre(study, prepared, point, problem, wanted)


def _problem(
    study: ManoeuvreStudy, prepared: Prepared, point: AssembledPoint, inputs: list[ModelInput]
) -> ControlProblem:
    e, mistakes = prepared.equations, Mistakes(study.document)
    waiting, controls = list(inputs), list[Control]()
    groups: tuple[Sequence[Any], ...] = (e.states, e.channels, e.unknowns)
    taken = {item.name for group in groups for item in group} | set(PATH)
    for text in study.controls:
        own = [waiting.pop(0) for _ in text.inputs]
        with mistakes.at("controls", text.name):
            if text.name in taken:
                raise InputError("is a name of the model; call the control otherwise")
            controls.append(_control(text, own, prepared, study))
    mistakes.refuse()
    names = Names(e, tuple(controls), study.track is not None)
    growth = _growth(study, names, mistakes)
    start, end, bounds = _state_bounds(study, names, point, growth, mistakes)
    limits, final = _ranges(study, names, mistakes)
    powers = [p for t, c in zip(study.controls, range(len(controls)), strict=True)
              for p in _powers(t, c, names)]  # fmt: skip
    terms = list[Any]()
    for name, weight in study.terms.items():
        with mistakes.at("minimise", name):
            terms += names.term(name, weight, powers)
    duration, path_start = (0.0, 0.0), _FREE
    with mistakes.at("duration"):
        duration = duration_bounds(study)[:2]
    path = _path(study, names, prepared, mistakes)
    with mistakes.at("start", "path.distance"):
        path_start = bounds_of(study.start.get("path.distance", "free"), "m")
    mistakes.refuse()
    return ControlProblem(
        e,
        _without(prepared, inputs),
        tuple(controls),
        duration,
        start,
        end,
        bounds,
        tuple(item for item in limits if item.what.kind != "state"),
        tuple(item for item in final if item.what.kind not in ("state", "control")),
        tuple(terms),
        growth,
        path,
        path_start,
    )


def _ranges(
    study: ManoeuvreStudy, names: Names, mistakes: Mistakes
) -> tuple[list[BoundedExpression], list[BoundedExpression]]:
    """Return what is bounded everywhere, and at the end."""
    limits, final = list[BoundedExpression](), list[BoundedExpression]()
    groups = ("limits", study.limits, limits), ("end", study.end, final)
    for group, given, found in groups:
        for name, value in given.items():
            with mistakes.at(group, name):
                item = names.bounded(name, value)
                found.append(item)
                if item.what.kind == "control":
                    control = names.controls[item.what.index]
                    if item.low > control.high or item.high < control.low:
                        raise InputError("is outside the bounds of the control")
    for name in study.start:
        with mistakes.at("start", name):
            if names.find(name)[0].kind not in ("state", "control", "path"):
                raise InputError("only states, controls and the path start so")
            if name == "path.offset":
                raise InputError("give the states that follow the path instead")
    begin = -np.inf
    with mistakes.at("start", "path.distance"):
        begin = bounds_of(study.start.get("path.distance", "free"), "m")[0]
    if study.track is not None:
        for item in final:
            if item.what.kind == "path" and item.what.index == 0:
                with mistakes.at("end", item.what.name):
                    _refuse_end_beyond(study.track, item.low)
                    if item.high <= begin:
                        raise InputError(f"is not beyond the start at {begin:g} m")
    return limits, final


def _refuse_end_beyond(track: PathTable, distance: float) -> None:
    """Refuse an end where the path is not known."""
    most = track.length * (1.0 + (BEYOND if track.closed else _LITTLE))
    if distance > most:
        longest = "a lap and a fifth" if track.closed else "up to its end"
        raise InputError(
            f"{distance:g} m is too far on a path of {track.length:.7g} m: drive {longest}"
        )


def _without(prepared: Prepared, inputs: list[ModelInput]) -> Floats:
    """Return the parameters, those zero that a control gives the value itself."""
    values = prepared.kernel.parameters
    index = {p.name: k for k, p in enumerate(prepared.equations.parameters)}
    for item in inputs:
        if item.is_parameter:
            values[index[item.parts[0].parameters[0]]] = 0.0
    return values


def duration_bounds(study: ManoeuvreStudy) -> tuple[float, float, float]:
    """Return the bounds of the final time and where to begin [s].

    Raises
    ------
    InputError
        If they are no times above zero.
    """
    given = study.duration
    low, high = bounds_of(_only_bounds(given), "s")
    guess = given.get("guess") if isinstance(given, dict) else None
    middle = 0.5 * (low + high) if np.isfinite(high) else 2.0 * low
    begin = with_unit(guess, "s") if guess is not None else middle
    if not 0.0 < low <= begin <= high:
        guessed = "" if guess is None else f" with the guess {begin:g} s"
        raise InputError(f"needs 0 < from <= guess <= to, not {low:g} s to {high:g} s{guessed}")
    return low, high, begin


def _only_bounds(given: Any) -> Any:
    return {k: v for k, v in given.items() if k != "guess"} if isinstance(given, dict) else given


def _control(
    text: ControlText, inputs: list[ModelInput], prepared: Prepared, study: ManoeuvreStudy
) -> Control:
    """Return a control with the parameters it enters."""
    e, entries = prepared.equations, list[tuple[int, int, float]]()
    index = {p.name: k for k, p in enumerate(e.parameters)}
    units = {item.unit for item in inputs}
    if len(units) != 1:
        raise InputError(f"its inputs have different units: {sorted(units)}")
    moves = False
    for item, factor in zip(inputs, text.inputs.values(), strict=True):
        for part in item.parts:
            if part.wheel:
                raise InputError("a road is no control")
            gain = factor * _number(prepared, part.gain)
            moves = moves or len(part.parameters) > 1
            for order, name in enumerate(part.parameters):
                entries.append((index[name], order, gain))
    (unit,) = units
    bounds = {"from": text.low, "to": text.high}
    low, high = bounds_of(bounds, unit)
    if not np.isfinite([low, high]).all():
        raise InputError("needs finite bounds")
    if low == high:
        raise InputError("its bounds are equal, so that nothing is left to choose")
    rate = _most("rate", text.rate, f"{unit}/s")
    bend = _most("acceleration", text.acceleration, f"{unit}/s^2")
    if not moves and np.isfinite(bend):
        raise InputError("acceleration: only controls that move a coordinate have one")
    edges = []
    for group in (study.start, study.end):
        usual: Any = 0.0 if moves and group is study.start and not study.periodic else "free"
        edges.append(bounds_of(group.get(text.name, usual), unit))
        if max(low, edges[-1][0]) > min(high, edges[-1][1]):
            raise InputError("its start or end is outside its bounds")
    order = BEND if moves else RAMP if np.isfinite(rate) else POINTS
    if order == POINTS and text.name in {**study.start, **study.end}:
        raise InputError("only controls with a rate have a value at start and end")
    return Control(text.name, unit, order, tuple(entries), low, high, rate, bend, *edges)


def _most(key: str, given: Any, unit: str) -> float:
    if given is None:
        return float("inf")
    try:
        value = with_unit(given, unit)
    except InputError as error:
        raise InputError(f"{key}: {error}") from None
    if not value > 0.0:
        raise InputError(f"{key}: must be above zero")
    return value


def _number(prepared: Prepared, gain: Any) -> float:
    entries = prepared.subject.system.table.entries
    symbols = ops.column([entry.symbol for entry in entries])
    value = ops.numeric([symbols], ops.column([ops.scalar(gain)]))
    return float(np.ravel(value(prepared.kernel.parameters))[0])


def _powers(text: ControlText, control: int, names: Names) -> list[tuple[Any, ...]]:
    """Return the powers of a control's forces on coordinates that are states."""
    found = []
    for name, factor in text.inputs.items():
        rate = f"{name.removeprefix('force:')}_rate"
        if name.startswith("force:") and rate in names.states:
            found.append(("power", control, names.states[rate], factor))
    return found


def _growth(study: ManoeuvreStudy, names: Names, mistakes: Mistakes) -> dict[int, float]:
    growth = {}
    for pattern, given in study.periodic.items():
        with mistakes.at("periodic", pattern):
            for index in names.matching(pattern):
                unit = names.equations.states[index].unit
                growth[index] = bounds_of(given, unit)[0]
    return growth


def _state_bounds(
    study: ManoeuvreStudy,
    names: Names,
    point: AssembledPoint,
    growth: dict[int, float],
    mistakes: Mistakes,
) -> tuple[Floats, Floats, Floats]:
    """Return the bounds of the states at the start, the end and between, each (n_x, 2)."""
    n = len(names.equations.states)
    start = np.column_stack([point.state, point.state])
    start[list(growth)] = _FREE
    end, bounds = np.tile(_FREE, (n, 1)), np.tile(_FREE, (n, 1))
    groups = (
        ("start", start, study.start),
        ("end", end, study.end),
        ("limits", bounds, study.limits),
    )
    for group, table, values in groups:
        for name, given in values.items():
            if name in names.states:
                index = names.states[name]
                with mistakes.at(group, name):
                    table[index] = bounds_of(given, names.equations.states[index].unit)
    for table, what in ((start, "start"), (end, "end")):
        low, high = np.maximum(table[:, 0], bounds[:, 0]), np.minimum(table[:, 1], bounds[:, 1])
        for outside in np.flatnonzero(low > high):
            name = names.equations.states[int(outside)].name
            mistakes.wrong((what, name), "is outside its limits")
    return start, end, bounds


def _path(
    study: ManoeuvreStudy, names: Names, prepared: Prepared, mistakes: Mistakes
) -> Corridor | None:
    table = study.track
    if table is None:
        return None
    body = prepared.subject.ports.body
    place = table.place or ((f"{body}.x", f"{body}.y") if body else ())
    if not place:
        mistakes.wrong(("path", "place"), "name the two states that follow the path")
        return None
    for name in place:
        if name not in names.states:
            mistakes.wrong(("path", "place"), unknown_name("state", name, names.states))
    if not set(place) <= set(names.states):
        return None
    x, y = (names.states[name] for name in place)
    return Corridor(table.distance, table.x, table.y, table.right, table.left, (x, y))
