"""Derivatives of a scenario's run: channels over time and key figures, by parameters."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.adjoint import (
    EventPassedError,
    FigureAdjoint,
    figure_adjoint,
    goes_back,
)
from vehicledyn.analyse.gradients.corner_passages import CornerMissedError, corner_passages
from vehicledyn.analyse.gradients.key_figures import FigureSlope, figure_slope, unit_of
from vehicledyn.analyse.gradients.motion_slopes import MotionSlopes
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.confirmation import unconfirmed_figure, unconfirmed_of
from vehicledyn.analyses.sensitivity.driving_failures import (
    bent_beams,
    bent_beams_of,
    driving_failure,
    driving_failure_of_run,
)
from vehicledyn.analyses.sensitivity.figure_names import check_names, is_figure_of_run
from vehicledyn.analyses.sensitivity.motion_study import MotionStudy
from vehicledyn.analyses.sensitivity.names import Directions, RequestedNames, directions, wanted
from vehicledyn.analyses.simulation.prepared_run import prepare_run
from vehicledyn.base.step_memory import Memory
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.kernel.engine import Method
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.sensitivity_table import SensitivityTable

Floats = NDArray[np.float64]


def find_motion_sensitivity(
    loaded: LoadedScenario, of: list[str], to: list[str], progress: Progress, *, memory: Memory
) -> SensitivityTable:
    """Return derivatives of a run's channels and key figures by parameters and start values.

    Parameters
    ----------
    loaded
        The scenario.
    of, to
        Names, see :mod:`vehicledyn.analyses.sensitivity.names`.
    progress
        Called with what is going on.
    memory
        Knows results of :data:`vehicledyn.analyses.sensitivity.motion_study.KINDS`.

    Raises
    ------
    InputError
        If a name means nothing.
    NumericalError
        If the run fails, or a derivative does not exist.
    """
    check_names(loaded, of, progress)
    names = _named_channels(loaded, of, progress)
    if _goes_back(loaded, of, to):
        return _figure_back(loaded, of[0], to, progress, memory)
    return _figures_ahead(loaded, (of, names), to, progress, memory)


def _figures_ahead(
    loaded: LoadedScenario,
    asked: tuple[list[str], list[str]],
    to: list[str],
    progress: Progress,
    memory: Memory,
) -> SensitivityTable:
    """Return derivatives of figures and channels by tangents: their names, and channels needed."""
    of, names = asked
    study = MotionStudy.of(loaded, names, progress, memory=memory)
    e, kernel = study.prepared.equations, study.prepared.kernel
    chosen = directions(e, kernel.parameters, study.start.state, to)
    motion = study.followed(chosen, progress)
    known = list(study.run_figures(motion)) if _needs_run(of, e) else []
    asked_for = wanted(e, of, known)
    table = _table(study, chosen, motion, asked_for)
    progress("confirming the derivatives by runs", None)
    unsure = unconfirmed_of(study, chosen, motion, asked_for)
    return replace(table, notes=(*table.notes, *unsure))


_MOST_LISTED = 12
"""Events that are listed one by one."""
_BACK_FROM = 64
"""Directions from which on one figure is found by adjoints."""


def _goes_back(loaded: LoadedScenario, of: list[str], to: list[str]) -> bool:
    """Return whether adjoints are quicker: one figure of a channel, many directions."""
    prepared, start = prepare_run(loaded, backend="auto", progress=lambda *_: None)
    e, solver = prepared.equations, loaded.scenario.solver
    alone = len(of) == 1 and "(" in of[0]
    plain = getattr(solver, "fixed_method", None) == Method.RK4 and goes_back(e)
    if not (alone and plain):
        return False
    chosen = directions(e, prepared.kernel.parameters, start.state, to)
    return len(chosen.values) >= _BACK_FROM


def _figure_back(
    loaded: LoadedScenario, name: str, to: list[str], progress: Progress, memory: Memory
) -> SensitivityTable:
    """Return the derivatives of one figure of a channel, by adjoints."""
    kind, _, channel = name.removesuffix(")").partition("(")
    study = MotionStudy.of(loaded, [channel], progress, back=True, memory=memory)
    course = study.changes()
    if course is not None and course.changes:
        return _figures_ahead(loaded, ([name], [channel]), to, progress, memory)
    e, kernel = study.prepared.equations, study.prepared.kernel
    chosen = directions(e, kernel.parameters, study.start.state, to)

    def figure(times: Floats, values: Floats) -> tuple[FigureSlope, Floats]:
        found = figure_slope(kind, times, values[:, 0], np.eye(len(times)))
        return found, found.slope[:, None]

    progress("following the motion back", None)

    plain = study.plain(progress)

    def find() -> FigureAdjoint | None:
        start = study.start.state, study.start.unknowns
        given = kernel.parameters, study.grid
        passages = corner_passages(kernel, study.code, study.grid, start, plain.corners)
        try:
            return figure_adjoint(
                study.code,
                *given,
                n_intervals=study.n_intervals,
                start=start,
                figure=figure,
                passages=passages if plain.corners else None,
            )
        except (EventPassedError, CornerMissedError):
            return None

    found = memory.recall_or_raise("adjoint", name, find)
    if found is None:
        return _figures_ahead(loaded, ([name], [channel]), to, progress, memory)
    moved = study.start_slopes(chosen) + chosen.by_state
    slope = found.by_parameter @ chosen.by_parameter + found.by_state @ moved
    unsure = unconfirmed_figure(study, chosen, kind, slope)
    about = e.channels[study.channels[0]]
    unit = unit_of(kind, about.unit)
    trouble, lost = found.figure.trouble, driving_failure_of_run(study)
    notes = [
        *study.notes,
        f"found by adjoints; {found.n_bytes / 1e6:.1f} MB of steps kept",
        *divided_steps(plain),
        *unsure,
        *bent_beams_of(study),
    ]
    if lost:
        notes.append(f"warning: {lost}")
    if trouble:
        notes.append(f"warning: '{name}' has no derivative: {trouble}")
    return SensitivityTable(
        loaded.title,
        loaded.scenario.model,
        chosen.quantities,
        chosen.values,
        (Quantity(name, unit, f"{kind} of {about.description}"),),
        np.array([found.figure.value]),
        np.full((1, len(slope)), np.nan) if trouble else slope[None, :],
        notes=tuple(notes),
    )


def divided_steps(motion: MotionSlopes) -> list[str]:
    """Return a line on corners of laws that are passed, none where there are none."""
    if motion.left_whole:
        return [
            "laws change their branch within steps that are not divided there; derivatives are "
            "those of these steps, and near those of the motion as far as the steps are short"
        ]
    if not motion.corners:
        return []
    missed = max(item.missed for item in motion.corners)
    places, them, one = counted_corners(motion), "them", "one"
    if len(motion.corners) == 1:
        them = one = "it"
    return [
        f"steps are divided at {places}; a run steps over {them}, and misses {one} by up to "
        f"{missed:.1e} of the size of a state"
    ]


def counted_corners(motion: MotionSlopes) -> str:
    """Return how many corners of laws a motion passes, and when the first, in words."""
    first = f"{motion.corners[0].time:.6g} s"
    if len(motion.corners) == 1:
        return f"a corner of a law, at {first}"
    return f"{len(motion.corners)} corners of laws, the first at {first}"


def _needs_run(of: list[str], equations: Any) -> bool:
    return any(is_figure_of_run(name, equations) for name in of)


def _named_channels(loaded: LoadedScenario, of: list[str], progress: Progress) -> list[str]:
    """Return the channels that names ask for."""
    prepared, _ = prepare_run(loaded, backend="auto", progress=progress)
    known = [name for name in of if is_figure_of_run(name, prepared.equations)]
    found = wanted(prepared.equations, of, known)
    return [*found.curves, *[channel for _, channel in found.figures]]


def _table(
    study: MotionStudy,
    chosen: Directions,
    motion: MotionSlopes,
    asked: RequestedNames,
) -> SensitivityTable:
    e, notes = study.prepared.equations, list(study.notes)
    places = {e.channels[k].name: place for place, k in enumerate(study.channels)}
    about = {c.name: c for c in e.channels}
    pairs = study.figures(asked, motion)
    found, figures = [slope for slope, _ in pairs], [quantity for _, quantity in pairs]
    slopes = np.zeros((len(found), len(chosen.values)))
    for row, (item, figure) in enumerate(zip(found, figures, strict=True)):
        slopes[row] = np.nan if item.trouble else item.slope
        if item.trouble:
            notes.append(f"warning: '{figure.name}' has no derivative: {item.trouble}")
    notes += [
        f"event '{event.name}' at {event.time:.6g} s; its instant moves with the parameters"
        for event in motion.events[:_MOST_LISTED]
    ]
    if len(motion.events) > _MOST_LISTED:
        notes.append(f"and {len(motion.events) - _MOST_LISTED} events more, which move as well")
    notes += [
        f"other coordinates become dependent at {time:.6g} s; the derivatives follow"
        for time in motion.changes
    ]
    notes += divided_steps(motion)
    notes += bent_beams(study, motion)
    if befell := driving_failure(study, motion):
        notes.append(f"warning: {befell}")
    elif motion.ended_by:
        notes.append(f"warning: event '{motion.ended_by}' ended the run at {motion.times[-1]:g} s")
    curves = [places[name] for name in asked.curves]
    for name, place in zip(asked.curves, curves, strict=True):
        lost = np.flatnonzero(~np.isfinite(motion.slopes[:, place]).all(axis=1))
        if lost.size:
            time = f"{motion.times[lost[0]]:g} s"
            notes.append(f"warning: '{name}' has no finite derivative at {time}")
    return SensitivityTable(
        study.loaded.title,
        study.loaded.scenario.model,
        chosen.quantities,
        chosen.values,
        tuple(figures),
        np.array([item.value for item in found]),
        slopes,
        tuple(Quantity(c.name, c.unit, c.description) for c in (about[n] for n in asked.curves)),
        motion.times,
        motion.values[:, curves].T,
        motion.slopes[:, curves].transpose(1, 0, 2),
        tuple(notes),
    )
