"""A scenario ready to be followed with its derivatives: start, motion and key figures."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.adjoint import FigureAdjoint
from vehicledyn.analyse.gradients.corner_watch import has_corners
from vehicledyn.analyse.gradients.equilibrium import BalancedStart, BalancedState, GivenSlopes
from vehicledyn.analyse.gradients.key_figures import (
    FigureSlope,
    figure_slope,
    sampled_slopes,
    unit_of,
)
from vehicledyn.analyse.gradients.motion import follow
from vehicledyn.analyse.gradients.motion_slopes import MotionSlopes
from vehicledyn.analyse.gradients.motion_stretches import KINDS as STRETCH_KINDS
from vehicledyn.analyse.gradients.motion_stretches import PartitionPiece
from vehicledyn.analyse.gradients.sampled_run import sampled_run
from vehicledyn.analyses.linear.written_starts import WrittenStarts
from vehicledyn.analyses.preparation.prepare import AssembledPoint, set_speed, start_point
from vehicledyn.analyses.preparation.prepared import Prepared, Progress
from vehicledyn.analyses.preparation.validity.bent_beams import MonitoredBeams
from vehicledyn.analyses.sensitivity.names import START, Directions, RequestedNames
from vehicledyn.analyses.sensitivity.pieces import Pieces
from vehicledyn.analyses.sensitivity.steps import FIXED, check_size, grid_of, missed_by
from vehicledyn.analyses.simulation.partitions.partition_course import PartitionCourse, RunCourse
from vehicledyn.analyses.simulation.partitions.steady_partition import SteadyPartition, Unsteady
from vehicledyn.analyses.simulation.prepared_run import prepare_run
from vehicledyn.analyses.simulation.wanted_outputs import needed_channels
from vehicledyn.base.errors import InputError, NumericalError, nearest_name
from vehicledyn.base.step_memory import Memory
from vehicledyn.base.units import shown
from vehicledyn.files.scenario import LoadedScenario
from vehicledyn.integrate.channel_ranges import Ranges
from vehicledyn.kernel.tangent_code import StepRow, TangentCode
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.road.manoeuvres.channel_recorder import Recording

Floats = NDArray[np.float64]

_AS_GOOD, _MOST_HALVINGS = 1e-5, 5
"""Part of a channel's range by which steps may miss it that stand for another method's, and how
often they are halved for it."""


KINDS = (*STRETCH_KINDS, MotionSlopes, FigureAdjoint, FigureSlope)
"""Results of the memory of a motion."""


@dataclass
class MotionStudy:
    """A scenario made ready to be followed with its derivatives, as often as wanted."""

    loaded: LoadedScenario
    prepared: Prepared
    start: AssembledPoint
    channels: list[int]
    code: TangentCode
    grid: StepRow
    n_intervals: int
    notes: list[str]
    course: PartitionCourse
    pieces: Pieces
    written: WrittenStarts
    memory: Memory = field(default_factory=Memory)
    held: tuple[int, ...] = ()
    """States whose start is given, so that it does not follow the parameters."""

    @staticmethod
    def of(
        loaded: LoadedScenario,
        names: list[str],
        progress: Progress,
        *,
        back: bool = False,
        memory: Memory | None = None,
    ) -> MotionStudy:
        """Prepare a scenario; ``names`` are the channels wanted besides those of key figures.

        With ``back`` the motion is to be followed back from the first of these. A ``memory`` knows
        results of :data:`KINDS`.
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
        ends = [k for pair in MonitoredBeams.of(prepared).columns for k in pair]
        chosen = chosen if back else [*needed_channels(prepared), *chosen, *ends]
        channels = list(dict.fromkeys(chosen))
        notes: list[str] = []
        grid, n_intervals = grid_of(loaded, prepared, start, notes)
        check_size(n_intervals, len(all_names))
        progress("deriving and compiling the tangents", None)
        code = TangentCode(prepared.equations, channels, back=back)
        course = PartitionCourse(prepared.subject.system, lambda: prepared.watch)
        kind = loaded.scenario.start or prepared.subject.usual_start
        written = WrittenStarts(prepared, loaded.scenario.speed or 0.0, assembles=kind == "nominal")
        study = MotionStudy(
            loaded,
            prepared,
            start,
            channels,
            code,
            grid,
            n_intervals,
            notes,
            course,
            Pieces(),
            written,
        )
        study.memory = memory or study.memory
        kept = getattr(loaded.scenario.solver, "fixed_method", None) in FIXED
        return study if kept else study._with_judged_steps(progress)

    def _with_judged_steps(self, progress: Progress) -> MotionStudy:
        """Return the same with steps so small that halving them does not move the samples.

        For scenarios whose own method has no derivatives and keeps to a tolerance instead.
        """
        study, values = self, self.plain(progress).values
        ranges = Ranges.of(self.prepared.equations, self.channels)
        for _ in range(_MOST_HALVINGS):
            progress("choosing the steps to follow", None)
            finer = replace(study.grid, per_interval=2 * study.grid.per_interval)
            found = replace(study, grid=finer).plain(progress).values
            missed = missed_by(ranges, values, found)
            if missed <= _AS_GOOD:
                break
            study, values = replace(study, grid=finer), found
        step = study.grid.interval / study.grid.per_interval
        notes = [f"derivatives are those of rk4 steps of {shown(step, 's')}"]
        if missed > _AS_GOOD:
            notes.append(
                f"warning: these steps miss the motion by up to {missed:.1e} of a channel's range; "
                "give the scenario solver.kind rk4 with a step that suits it"
            )
        return replace(study, notes=notes)

    def moved(self, changes: Mapping[str, float]) -> MotionStudy:
        """Return the same with other values of parameters, in SI, and the start that follows.

        Names that begin with ``start.`` are those of states, whose start then follows nothing;
        those that were given before stay as they are.
        """
        e = self.prepared.equations
        states = [s.name for s in e.states]
        names = [p.name for p in e.parameters]
        parameters = self.prepared.kernel.parameters
        given = {states[k]: float(self.start.state[k]) for k in self.held}
        given |= {
            name.removeprefix(START): v for name, v in changes.items() if name.startswith(START)
        }
        for name, value in changes.items():
            if not name.startswith(START):
                parameters[names.index(name)] = value
        kernel = self.prepared.kernel.with_parameters(parameters)
        prepared = replace(self.prepared, kernel=kernel)
        scenario = self.loaded.scenario
        begun = self.written.applied(prepared)
        start = start_point(begun, scenario.speed or 0.0, scenario.start)
        held = tuple(states.index(name) for name in given)
        if held:
            state = start.state.copy()
            state[list(held)] = list(given.values())
            unknowns = kernel.solve_unknowns(0.0, state, start.unknowns)
            start = AssembledPoint(state, unknowns)
        return replace(self, prepared=prepared, start=start, held=held)

    def figures(
        self, asked: RequestedNames, motion: MotionSlopes
    ) -> list[tuple[FigureSlope, Quantity]]:
        """Return the figures asked for, those of the run first."""
        e = self.prepared.equations
        places = {e.channels[k].name: place for place, k in enumerate(self.channels)}
        run = self.run_figures(motion) if asked.others else {}
        found = [_known(run, name) for name in asked.others]
        for kind, name in asked.figures:
            place = places[name]
            channel = e.channels[self.channels[place]]
            slope = figure_slope(
                kind,
                motion.times,
                motion.values[:, place],
                motion.slopes[:, place],
                motion.end_slope,
            )
            unit = unit_of(kind, channel.unit)
            words = f"{kind} of {channel.description}"
            found.append((slope, Quantity(f"{kind}({name})", unit, words)))
        return found

    def followed(self, chosen: Directions, progress: Progress) -> MotionSlopes:
        """Return the motion with its derivatives."""
        by_state = self.start_slopes(chosen)
        by_state[list(self.held)] = 0.0
        by_state = by_state + chosen.by_state
        check_size(self.n_intervals, len(self.channels) * by_state.shape[1])
        given = partial(
            follow,
            grid=self.grid,
            n_intervals=self.n_intervals,
            start=(self.start.state, self.start.unknowns),
            directions=(chosen.by_parameter, by_state),
            n_channels=len(self.channels),
            progress=lambda part: progress("following the motion with its tangents", part),
            memory=self.memory,
        )
        kernel = self.prepared.kernel
        if self.course.needed(kernel) and SteadyPartition.sees(kernel, self.grid):
            # A run that fails may do so since its dependent coordinates have to change.
            with suppress(Unsteady, NumericalError):
                return given(self.code, kernel, watched=SteadyPartition(kernel).take)
        first, *later = self._parts()
        return given(first.code, first.kernel, later=later)

    def changes(self) -> RunCourse | None:
        """Return the run with its changes of dependent coordinates, None where there are none."""
        kernel = self.prepared.kernel
        if not self.course.needed(kernel):
            return None
        start = (self.start.state, self.start.unknowns)
        return self.course.run(kernel, self.grid, self.n_intervals, start)

    def _parts(self) -> tuple[PartitionPiece, ...]:
        """Return the pieces of the motion between changes of its dependent coordinates."""
        begin = PartitionPiece(self.grid.start, self.prepared.kernel, self.code)
        course, e = self.changes(), self.prepared.equations
        if course is None or not course.changes:
            return (begin,)
        names = [e.channels[k].name for k in self.channels]
        return self.pieces.of(begin, course.changes, names)

    def plain(self, progress: Progress) -> MotionSlopes:
        """Return the motion without derivatives, as those by no directions."""
        start = self.start.state, self.start.unknowns
        given = self.prepared.kernel.parameters, *start, self.grid, self.channels
        return self.memory.recall_or_raise("plain", given, self._plain)

    def _plain(self) -> MotionSlopes:
        kernel, n_x = self.prepared.kernel, len(self.start.state)
        start, given = (self.start.state, self.start.unknowns), (self.grid, self.n_intervals)
        if has_corners(self.code, self.grid):
            first, *later = self._parts()
            return self._without_slopes(first, later)
        course = self.changes()
        if course is not None:
            wanted = course.channels[:, self.channels]
            nothing = np.zeros((*wanted.shape, 0))
            last, ended_by = course.states[-1], course.ended_by
            return MotionSlopes(
                course.times, wanted, nothing, last, np.zeros((n_x, 0)), [], ended_by
            )
        if kernel.equations.events:
            return self._without_slopes(PartitionPiece(self.grid.start, kernel, self.code), [])
        times, values, state = sampled_run(kernel, *given, start)
        chosen = values[:, self.channels]
        empty = np.zeros((*chosen.shape, 0))
        return MotionSlopes(times, chosen, empty, state, np.zeros((n_x, 0)), [], "")

    def _without_slopes(self, first: PartitionPiece, later: list[PartitionPiece]) -> MotionSlopes:
        """Return the motion as it is followed, by no directions."""
        none = [np.zeros((n, 0)) for n in (len(first.kernel.parameters), len(self.start.state))]
        return follow(
            first.code,
            first.kernel,
            self.grid,
            n_intervals=self.n_intervals,
            start=(self.start.state, self.start.unknowns),
            directions=(none[0], none[1]),
            later=later,
            n_channels=len(self.channels),
        )

    def start_slopes(self, chosen: Directions) -> Floats:
        """Return how the start follows the parameters."""
        given, balanced = self.given_slopes(chosen), self.balance()
        if balanced is None:
            found = given.moving
        else:
            found = balanced.slopes(self.code, chosen.by_parameter, given)
        begun = self.written.applied(self.prepared)
        return self.written.with_given_rates(begun, self.start, chosen.by_parameter, found)

    def balance(self) -> BalancedStart | None:
        """Return the equilibrium that the start is taken from, None where all of it is given."""
        subject, scenario = self.prepared.subject, self.loaded.scenario
        speed = scenario.speed or 0.0
        kind = scenario.start or subject.usual_start
        kernel, e = self.prepared.kernel, self.prepared.equations
        if kind == "nominal":
            return None
        held = kernel.parameters
        balanced_speed = 0.0 if kind == "static" else speed
        state, others = self.start.state.copy(), list[int]()
        pairs = subject.balance_pairs(e, balanced_speed)
        if kind == "static":
            others = [k for k in e.speeds if k not in pairs[0]]
            begun = self.written.applied(self.prepared)
            state[others] = subject.still_state(begun.equations)[others]
        set_speed(self.prepared, balanced_speed)
        parameters = kernel.parameters
        kernel.set_parameters(held)
        point = (state, self.start.unknowns)
        balance = BalancedState(parameters, subject.balance_time, point, pairs)
        return BalancedStart(balance, tuple(others))

    def given_slopes(self, chosen: Directions) -> GivenSlopes:
        """Return how the given states follow the speed, in which they are linear, and others."""
        subject, e = self.prepared.subject, self.prepared.equations
        speed = self.loaded.scenario.speed or 0.0
        parameters = self.prepared.kernel.parameters
        slopes = self.written.slopes(parameters) @ chosen.by_parameter
        names = [p.name for p in e.parameters]
        if "speed" in names and "speed" in subject.parameters_at(speed or 1.0):
            faster = subject.start_state(e, speed + 1.0) - subject.start_state(e, speed)
            slopes += np.outer(faster, chosen.by_parameter[names.index("speed")])
        if not self.is_static:
            return GivenSlopes(slopes, slopes)
        return GivenSlopes(slopes, self.written.still(parameters) @ chosen.by_parameter)

    def given_bends(self, chosen: Directions, direction: Floats) -> GivenSlopes:
        """Return how these change along a direction of the parameters."""
        parameters, written = self.prepared.kernel.parameters, self.written
        moving = written.bent(parameters, direction) @ chosen.by_parameter
        if not self.is_static:
            return GivenSlopes(moving, moving)
        still = written.bent(parameters, direction, is_still=True)
        return GivenSlopes(moving, still @ chosen.by_parameter)

    @property
    def is_static(self) -> bool:
        """Whether the start is balanced at rest before it is given its velocities."""
        return (self.loaded.scenario.start or self.prepared.subject.usual_start) == "static"

    def run_figures(self, motion: MotionSlopes) -> dict[str, tuple[FigureSlope, Quantity]]:
        """Return the key figures of the run with their derivatives."""
        e = self.prepared.equations
        names = [e.channels[k].name for k in self.channels]
        units = {e.channels[k].name: e.channels[k].unit for k in self.channels}
        about: dict[str, Quantity] = {}

        def figures(samples: Floats) -> dict[str, float]:
            times, values = samples[:, 0], samples[:, 1:]
            recording = Recording(times, dict(zip(names, values.T, strict=True)), units)
            found = {}
            for entry in self.prepared.subject.summarise(recording):
                if isinstance(entry.value, float):
                    about[entry.name] = Quantity(entry.name, entry.unit, entry.description)
                    found[entry.name] = entry.value
            return found

        moved = np.zeros_like(motion.slopes[:, :1])
        moved[-1, 0] = motion.end_slope
        found = sampled_slopes(
            figures,
            np.concatenate([motion.times[:, None], motion.values], axis=1),
            np.concatenate([moved, motion.slopes], axis=1),
        )
        return {name: (slope, about[name]) for name, slope in found.items()}


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
