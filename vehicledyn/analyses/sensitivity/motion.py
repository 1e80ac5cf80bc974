"""Derivatives of a scenario's run: channels over time and key figures, by parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.adjoint import figure_adjoint
from vehicledyn.analyse.gradients.key_figures import FigureSlope, figure_slope, sampled_slopes
from vehicledyn.analyse.gradients.motion import (
    Balance,
    MotionSlopes,
    follow,
    sampled_run,
    start_slopes,
)
from vehicledyn.analyses.preparation.prepare import Point, set_speed, start_point
from vehicledyn.analyses.preparation.prepared import Prepared, Progress
from vehicledyn.analyses.sensitivity.names import Directions, Wanted, directions, wanted
from vehicledyn.analyses.simulation.prepared_run import prepare_run
from vehicledyn.analyses.simulation.wanted_outputs import needed_channels
from vehicledyn.base.errors import InputError, nearest_name
from vehicledyn.base.units import shown
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.integrate.accuracy.proposed_step import proposed_step
from vehicledyn.integrate.fixed_step import steps_per_interval
from vehicledyn.kernel.engine import Method
from vehicledyn.kernel.tangent_code import Grid, TangentCode
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.sensitivity_table import SensitivityTable
from vehicledyn.road.manoeuvres.channel_recorder import Recording

Floats = NDArray[np.float64]

_FIXED = (Method.RK4, Method.SYMPLECTIC_EULER)


@dataclass
class MotionStudy:
    """A scenario made ready to be followed with its derivatives, as often as wanted."""

    loaded: LoadedScenario
    prepared: Prepared
    start: Point
    channels: list[int]
    code: TangentCode
    grid: Grid
    n_intervals: int
    notes: list[str]

    @staticmethod
    def of(
        loaded: LoadedScenario, names: list[str], progress: Progress, *, back: bool = False
    ) -> MotionStudy:
        """Prepare a scenario; ``names`` are the channels wanted besides those of key figures.

        With ``back`` the motion is to be followed back from the first of these.
        """
        prepared, start = prepare_run(loaded, backend="auto", progress=progress)
        if prepared.has_multipliers:
            raise InputError(
                f"the constraints of '{prepared.equations.name}' are treated with multipliers; "
                "derivatives of its motion need 'constraint_method: partitioning'"
            )
        all_names = [c.name for c in prepared.equations.channels]
        for name in names:
            if name not in all_names:
                guess = nearest_name(name, all_names)
                hint = f"; did you mean '{guess}'?" if guess else ""
                raise InputError(f"'{name}' is no channel of '{prepared.equations.name}'{hint}")
        chosen = [all_names.index(name) for name in names]
        chosen = chosen if back else [*needed_channels(prepared), *chosen]
        channels = list(dict.fromkeys(chosen))
        notes: list[str] = []
        grid, n_intervals = _grid(loaded, prepared, start, notes)
        progress("deriving and compiling the tangents", None)
        code = TangentCode(prepared.equations, channels, back=back)
        return MotionStudy(loaded, prepared, start, channels, code, grid, n_intervals, notes)

    def moved(self, changes: Mapping[str, float]) -> MotionStudy:
        """Return the same with other values of parameters, in SI, and the start that follows."""
        names = [p.name for p in self.prepared.equations.parameters]
        parameters = self.prepared.kernel.parameters
        for name, value in changes.items():
            parameters[names.index(name)] = value
        kernel = self.prepared.kernel.with_parameters(parameters)
        prepared = replace(self.prepared, kernel=kernel)
        scenario = self.loaded.scenario
        start = start_point(prepared, scenario.speed or 0.0, scenario.start)
        return replace(self, prepared=prepared, start=start)

    def figures(self, asked: Wanted, motion: MotionSlopes) -> list[tuple[FigureSlope, Quantity]]:
        """Return the figures asked for, those of the run first."""
        e = self.prepared.equations
        places = {e.channels[k].name: place for place, k in enumerate(self.channels)}
        run = self.run_figures(motion) if asked.others else {}
        found = [_known(run, name) for name in asked.others]
        for kind, name in asked.figures:
            place = places[name]
            channel = e.channels[self.channels[place]]
            slope = figure_slope(
                kind, motion.times, motion.values[:, place], motion.slopes[:, place]
            )
            unit = f"{channel.unit}*s" if kind == "integral" else channel.unit
            words = f"{kind} of {channel.description}"
            found.append((slope, Quantity(f"{kind}({name})", unit, words)))
        return found

    def followed(self, chosen: Directions, progress: Progress) -> MotionSlopes:
        """Return the motion with its derivatives."""
        by_state = self.start_slopes(chosen) + chosen.by_state
        return follow(
            self.code,
            self.prepared.kernel,
            self.grid,
            n_intervals=self.n_intervals,
            start=(self.start.state, self.start.unknowns),
            directions=(chosen.by_parameter, by_state),
            progress=lambda part: progress("following the motion with its tangents", part),
        )

    def plain(self, progress: Progress) -> MotionSlopes:
        """Return the motion without derivatives, as those by no directions."""
        kernel, n_x = self.prepared.kernel, len(self.start.state)
        if kernel.equations.events:
            none = np.zeros((len(kernel.parameters), 0)), np.zeros((n_x, 0))
            start = (self.start.state, self.start.unknowns)
            return follow(
                self.code,
                kernel,
                self.grid,
                n_intervals=self.n_intervals,
                start=start,
                directions=none,
            )
        times, values, state = sampled_run(
            kernel, self.grid, self.n_intervals, (self.start.state, self.start.unknowns)
        )
        chosen = values[:, self.channels]
        empty = np.zeros((*chosen.shape, 0))
        return MotionSlopes(times, chosen, empty, state, np.zeros((n_x, 0)), [], "")

    def start_slopes(self, chosen: Directions) -> Floats:
        """Return how the start follows the parameters; given states follow the speed alone."""
        subject, scenario = self.prepared.subject, self.loaded.scenario
        speed = scenario.speed or 0.0
        kind = scenario.start or subject.usual_start
        kernel, e = self.prepared.kernel, self.prepared.equations
        given = self._given(chosen, speed)
        if kind == "nominal":
            return given
        held = kernel.parameters
        balanced_speed = 0.0 if kind == "static" else speed
        state = self.start.state.copy()
        pairs = subject.balance_pairs(e, balanced_speed)
        if kind == "static":
            others = [k for k in e.speeds if k not in pairs[0]]
            state[others] = subject.still_state(e)[others]
        set_speed(self.prepared, balanced_speed)
        try:
            point = (state, self.start.unknowns)
            balance = Balance(kernel.parameters, subject.balance_time, point, pairs)
            moved = given if kind == "steady" else np.zeros(given.shape)
            found = start_slopes(self.code, balance, chosen.by_parameter, moved)
        finally:
            kernel.set_parameters(held)
        if kind == "static":
            found[others] = given[others]
        return found

    def _given(self, chosen: Directions, speed: float) -> Floats:
        """Return how the given states follow the speed, in which they are linear."""
        subject, e = self.prepared.subject, self.prepared.equations
        slopes = np.zeros(chosen.by_state.shape)
        names = [p.name for p in e.parameters]
        if "speed" in names and "speed" in subject.parameters_at(speed or 1.0):
            faster = subject.start_state(e, speed + 1.0) - subject.start_state(e, speed)
            slopes += np.outer(faster, chosen.by_parameter[names.index("speed")])
        return slopes

    def run_figures(self, motion: MotionSlopes) -> dict[str, tuple[FigureSlope, Quantity]]:
        """Return the key figures of the run with their derivatives."""
        e = self.prepared.equations
        names = [e.channels[k].name for k in self.channels]
        units = {e.channels[k].name: e.channels[k].unit for k in self.channels}
        about: dict[str, Quantity] = {}

        def figures(values: Floats) -> dict[str, float]:
            recording = Recording(motion.times, dict(zip(names, values.T, strict=True)), units)
            found = {}
            for entry in self.prepared.subject.summarise(recording):
                if isinstance(entry.value, float):
                    about[entry.name] = Quantity(entry.name, entry.unit, entry.description)
                    found[entry.name] = entry.value
            return found

        found = sampled_slopes(figures, motion.values, motion.slopes)
        return {name: (slope, about[name]) for name, slope in found.items()}


def find_motion_sensitivity(
    loaded: LoadedScenario, of: list[str], to: list[str], progress: Progress
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

    Raises
    ------
    InputError
        If a name means nothing.
    NumericalError
        If the run fails, or a derivative does not exist.
    """
    names = _named_channels(loaded, of, progress)
    if _goes_back(loaded, of, to):
        return _figure_back(loaded, of[0], to, progress)
    study = MotionStudy.of(loaded, names, progress)
    e, kernel = study.prepared.equations, study.prepared.kernel
    chosen = directions(e, kernel.parameters, study.start.state, to)
    motion = study.followed(chosen, progress)
    known = list(study.run_figures(motion)) if _needs_run(of, e) else []
    return _table(study, chosen, motion, wanted(e, of, known))


_BACK_FROM = 64
"""Directions from which on one figure is found by adjoints."""


def _goes_back(loaded: LoadedScenario, of: list[str], to: list[str]) -> bool:
    """Return whether adjoints are quicker: one figure of a channel, many directions, no events."""
    prepared, start = prepare_run(loaded, backend="auto", progress=lambda *_: None)
    e, solver = prepared.equations, loaded.scenario.solver
    alone = len(of) == 1 and "(" in of[0]
    plain = getattr(solver, "fixed_method", None) == Method.RK4 and not e.events
    if not (alone and plain):
        return False
    chosen = directions(e, prepared.kernel.parameters, start.state, to)
    return len(chosen.values) >= _BACK_FROM


def _figure_back(
    loaded: LoadedScenario, name: str, to: list[str], progress: Progress
) -> SensitivityTable:
    """Return the derivatives of one figure of a channel, by adjoints."""
    kind, _, channel = name.removesuffix(")").partition("(")
    study = MotionStudy.of(loaded, [channel], progress, back=True)
    e, kernel = study.prepared.equations, study.prepared.kernel
    chosen = directions(e, kernel.parameters, study.start.state, to)

    def figure(times: Floats, values: Floats) -> tuple[FigureSlope, Floats]:
        found = figure_slope(kind, times, values[:, 0], np.eye(len(times)))
        return found, found.slope[:, None]

    progress("following the motion back", None)
    found = figure_adjoint(
        study.code,
        kernel,
        study.grid,
        n_intervals=study.n_intervals,
        start=(study.start.state, study.start.unknowns),
        figure=figure,
    )
    moved = study.start_slopes(chosen) + chosen.by_state
    slope = found.by_parameter @ chosen.by_parameter + found.by_state @ moved
    about = e.channels[study.channels[0]]
    unit = f"{about.unit}*s" if kind == "integral" else about.unit
    trouble = found.figure.trouble
    notes = [*study.notes, f"found by adjoints; {found.n_bytes / 1e6:.1f} MB of steps kept"]
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


def _known(run: dict[str, tuple[FigureSlope, Quantity]], name: str) -> tuple[FigureSlope, Quantity]:
    """Return a figure of the run.

    Raises
    ------
    InputError
        If there is none of this name.
    """
    if name not in run:
        guess = nearest_name(name, run)
        hint = f"; did you mean '{guess}'?" if guess else ""
        raise InputError(f"the run has no key figure '{name}'{hint}")
    return run[name]


def _needs_run(of: list[str], equations: Any) -> bool:
    channels = {c.name for c in equations.channels}
    return any(name not in channels and "(" not in name for name in of)


def _named_channels(loaded: LoadedScenario, of: list[str], progress: Progress) -> list[str]:
    """Return the channels that names ask for."""
    prepared, _ = prepare_run(loaded, backend="auto", progress=progress)
    known = [name for name in of if name not in {c.name for c in prepared.equations.channels}]
    found = wanted(prepared.equations, of, known)
    return [*found.curves, *[channel for _, channel in found.figures]]


def _grid(
    loaded: LoadedScenario, prepared: Prepared, start: Point, notes: list[str]
) -> tuple[Grid, int]:
    """Return the steps of a scenario; a method without derivatives is replaced, as noted."""
    solver, interval = loaded.scenario.solver, loaded.scenario.output.interval
    method = getattr(solver, "fixed_method", None)
    step = getattr(solver, "step", None) if method in _FIXED else None
    if method not in _FIXED:
        method = Method.RK4
    if step is None:
        point = (0.0, start.state, start.unknowns)
        step = proposed_step(prepared.kernel, method, point, interval)
        name = Method(method).name.lower()
        notes.append(f"derivatives are those of {name} steps of {shown(step, 's')}")
    duration = loaded.scenario.duration
    per_interval = steps_per_interval(step, interval)
    return Grid(int(method), 0.0, interval, per_interval), round(duration / interval)


def _table(
    study: MotionStudy,
    chosen: Directions,
    motion: MotionSlopes,
    asked: Wanted,
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
        for event in motion.events
    ]
    if motion.ended_by:
        notes.append(f"warning: event '{motion.ended_by}' ended the run at {motion.times[-1]:g} s")
    curves = [places[name] for name in asked.curves]
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
