"""The equations of a study, compiled once, and the parameters and start of each of its cases."""

from __future__ import annotations

import fnmatch
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from vehicledyn.analyses.hunting.parameter_starts import starting_at, starts_of
from vehicledyn.analyses.preparation.build_model import build_subject, manoeuvre_of
from vehicledyn.analyses.preparation.prepare import AssembledPoint, Vector, prepare, start_point
from vehicledyn.analyses.preparation.prepared import Derived, Prepared, Progress
from vehicledyn.analyses.preparation.rate_determinacy import rate_monitor_of
from vehicledyn.analyses.preparation.runnable import Subject
from vehicledyn.analyses.simulation.chosen_step import leaves_step, with_step
from vehicledyn.analyses.simulation.judgement import judged_by
from vehicledyn.analyses.simulation.lost_control import PATH_ERROR
from vehicledyn.analyses.simulation.open_contacts import refuse_open_contacts
from vehicledyn.analyses.simulation.partitions.repartitioning import simulate_monitored
from vehicledyn.analyses.simulation.sunk_wheels import refuse_sunk_wheels
from vehicledyn.base.errors import InputError, VehicledynError, nearest_name
from vehicledyn.codegen.toolchain.fingerprint import fingerprint
from vehicledyn.files.scenario.load import LoadedScenario
from vehicledyn.integrate.batch import Batch, make_batch
from vehicledyn.integrate.channel_ranges import watched_channels
from vehicledyn.integrate.judged_quantities import Judged
from vehicledyn.integrate.lane_run import suited_lanes
from vehicledyn.integrate.simulate import Solver
from vehicledyn.integrate.task import Statistics
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.make_kernel import Backend
from vehicledyn.kernel.rate_monitor import RateMonitor
from vehicledyn.multibody.loops.assembled_start import DrawnStarts
from vehicledyn.results.store.study_layout import StudyFigure
from vehicledyn.road.manoeuvres.channel_recorder import Recording
from vehicledyn.studies import indexed_random as scatter
from vehicledyn.studies.axes import Axis
from vehicledyn.studies.case_beams import CaseBeams
from vehicledyn.studies.load import leaves
from vehicledyn.studies.recipe import Recipe
from vehicledyn.studies.starts import RestPoint, find_reference, start_of
from vehicledyn.symbolic.equations import Channel, Equations

_PROBES = (101, 102)


@dataclass(frozen=True)
class Case:
    """A case ready to run: parameters in SI in the order of the equations, start and subject."""

    parameters: Vector
    start: AssembledPoint
    subject: Subject


@dataclass(frozen=True)
class Shortcut:
    """Where the parameters that vary stand in a resolved scenario, if they all do.

    ``base`` are all parameters (n_parameters,); those of the indices ``varying`` have the values
    at ``paths``.
    """

    base: Vector
    varying: tuple[int, ...]
    paths: tuple[tuple[str, ...], ...]

    def parameters(self, resolved: dict[str, Any]) -> Vector:
        """Return the parameters of a scenario from its plain data."""
        found = self.base.copy()
        for index, path in zip(self.varying, self.paths, strict=True):
            found[index] = _at(resolved, path)
        return found


@dataclass
class CaseModel:
    """What all cases of one structure share."""

    recipe: Recipe
    loaded: LoadedScenario
    prepared: Prepared
    batch: Batch
    kept: list[int]
    needed: list[int]
    has_figures: bool
    reference: RestPoint | None
    shortcut: Shortcut | None = None
    columns: list[int] = field(init=False)

    def __post_init__(self) -> None:
        """List the channels to compute: those to keep first, then the others needed."""
        self.columns = list(dict.fromkeys([*self.kept, *self.needed, *self.beams.columns]))

    @property
    def channels(self) -> list[Channel]:
        """The channels to keep."""
        return [self.prepared.equations.channels[k] for k in self.kept]

    def case(self, values: Sequence[float], name: str) -> Case:
        """Return a case with these values of the axes.

        Raises
        ------
        VehicledynError
            If the values do not go together or there is no point to start from.
        """
        loaded = self.recipe.scenario(values, name)
        if self.shortcut is None:
            subject = build_subject(loaded)
            parameters = _parameters_of(subject, self.prepared)
            equations = starting_at(self.prepared.equations, self.prepared.subject, subject)
        else:
            subject = self.prepared.subject.in_manoeuvre(manoeuvre_of(loaded))
            parameters, equations = (
                self.shortcut.parameters(loaded.resolved),
                self.prepared.equations,
            )
        equations = self._drawn(equations, subject, parameters)
        kernel = replace(self.prepared.kernel, equations=equations).with_parameters(parameters)
        own = replace(self.prepared, subject=subject, equations=equations, kernel=kernel)
        scenario = loaded.scenario
        start = start_of(own, scenario.speed or 0.0, scenario.start, self.reference)
        refuse_sunk_wheels(own, start)
        refuse_open_contacts(own, start)
        return Case(own.kernel.parameters, start, subject)

    def _drawn(self, equations: Equations, subject: Subject, parameters: Vector) -> Equations:
        """Return equations that start where the loops of a case are assembled to."""
        if self._drawn_starts is None:
            return equations
        known = {p.name: v for p, v in zip(equations.parameters, parameters, strict=True)}
        values = np.array([known[entry.name] for entry in subject.system.table.entries])
        starts = self._drawn_starts.at(values, starts_of(subject))
        states = [replace(s, start=starts.get(s.name, s.start)) for s in equations.states]
        return replace(equations, states=tuple(states))

    @cached_property
    def _drawn_starts(self) -> DrawnStarts | None:
        """The starts that follow the loops, None where an equilibrium is sought from them."""
        kind = self.loaded.scenario.start or self.prepared.subject.usual_start
        if kind != "nominal":
            return None
        return DrawnStarts.of(self.prepared.subject.system, self.prepared.equations)

    def run_monitored(self, kernel: Kernel, solver: Solver, **span: Any) -> Statistics:
        """Integrate one case as a run of its own does, see ``simulate_monitored``."""
        return simulate_monitored(
            self.prepared.subject.system,
            kernel,
            solver,
            progress=_silent,
            happened=_silent,
            watch=lambda: self.prepared.watch,
            **span,
        )

    @cached_property
    def solver(self) -> Any:
        """Settings of the method, with the step that suits the start where none is given."""
        scenario = self.loaded.scenario
        if not leaves_step(scenario.solver):
            return scenario.solver
        start = start_point(self.prepared, scenario.speed or 0.0, scenario.start)
        kernel, interval = self.prepared.kernel, scenario.output.interval
        return with_step(scenario.solver, kernel, start, interval)

    def judged(self, case: Case) -> Judged:
        """Return what the accuracy of a case is judged by: its key figures, or what is kept."""
        if self.has_figures:
            return judged_by(case.subject, self.prepared.equations, by_itself=False)
        known = set(watched_channels(self.prepared.equations))
        return Judged([k for k in self.kept if k in known], by_itself=False)

    @cached_property
    def beams(self) -> CaseBeams:
        """The beams that are watched."""
        return CaseBeams.of(self.prepared)

    def beam_figures(self, case: Case, samples: Vector) -> list[StudyFigure]:
        """Return what beams do in a case that their models do not hold for."""
        return self.beams.figures(lambda k: samples[:, self.columns.index(k)], case.parameters)

    @cached_property
    def rates(self) -> RateMonitor | None:
        """What watches rates that constraints without loops determine, None without such."""
        return rate_monitor_of(self.prepared.equations, lambda: self.prepared.watch)

    def figures(self, case: Case, times: Vector, samples: Vector) -> list[Any]:
        """Return the key figures of a case from its samples (n_times, n_columns)."""
        channels = {self.prepared.equations.channels[k]: k for k in self.needed}
        columns = {c.name: samples[:, self.columns.index(k)] for c, k in channels.items()}
        units = {c.name: c.unit for c in channels}
        return list(case.subject.summarise(Recording(times, columns, units)))


def make_model(
    recipe: Recipe,
    values: Sequence[float],
    *,
    patterns: Sequence[str] | None,
    figures: bool,
    lanes: int | None,
    backend: Backend,
    progress: Progress,
) -> CaseModel:
    """Return the model of all cases whose choices are those of a case with these values.

    It is made from the scenario with these choices alone, or from the case itself where they
    need others of its values.

    Raises
    ------
    VehicledynError
        If no such scenario can be brought to run.
    """
    loaded = _template(recipe, values)
    prepared = prepare(loaded, backend=backend, progress=progress, evaluations=math.inf)
    _check_equations(recipe, values, prepared)
    solver: Any = loaded.scenario.solver
    check = getattr(solver, "check", None)
    if check is not None:
        check(prepared.equations)
    speed, kind = loaded.scenario.speed or 0.0, loaded.scenario.start
    progress("finding the point to start from", None)
    reference = find_reference(prepared, speed, kind)
    names = [c.name for c in prepared.equations.channels]
    needed: list[str] = []
    if figures or PATH_ERROR in names:  # who loses the car is known by its key figures
        needed = prepared.subject.channels(prepared.equations)
    return CaseModel(
        recipe,
        loaded,
        prepared,
        make_batch(prepared.kernel, lanes=suited_lanes(solver, lanes), progress=progress),
        chosen_channels(names, patterns),
        [names.index(name) for name in needed],
        figures,
        reference,
        _find_shortcut(recipe, values, prepared, reference),
    )


def chosen_channels(names: Sequence[str], patterns: Sequence[str] | None) -> list[int]:
    """Return the indices of the channels that match some patterns; all for None.

    Raises
    ------
    InputError
        If a pattern matches nothing.
    """
    if patterns is None:
        return list(range(len(names)))
    wrong = []
    for pattern in patterns:
        if not any(fnmatch.fnmatchcase(name, pattern) for name in names):
            guess = nearest_name(pattern, names)
            hint = f"; did you mean '{guess}'?" if guess else ""
            wrong.append(f"output.channels: '{pattern}' matches no channel{hint}")
    if wrong:
        raise InputError("\n".join(wrong))
    return [k for k, n in enumerate(names) if any(fnmatch.fnmatchcase(n, p) for p in patterns)]


def _check_equations(recipe: Recipe, values: Sequence[float], prepared: Prepared) -> None:
    """Refuse quantities that change the equations or their tables, not just parameters.

    Only parts that look up tables have numbers in their equations, so only these are looked at.
    """
    if not prepared.equations.tables or all(axis.is_choice for axis in recipe.axes):
        return
    known = _identity(prepared.equations)
    place = _probe(recipe.axes, values, _PROBES[0])
    if _identity(_equations_at(recipe, place)) == known:
        return
    wrong, known = [], _identity(_equations_at(recipe, values))
    for index, axis in enumerate(recipe.axes):
        own = [*values[:index], place[index], *values[index + 1 :]]
        if not axis.is_choice and _identity(_equations_at(recipe, own)) != known:
            wrong.append(f"'{axis.key}'")
    raise InputError(
        f"cases.vary: {', '.join(wrong) or 'the keys together'}: changes the equations or the "
        "curves in them, not just parameters, and cannot vary as a quantity"
    )


def _equations_at(recipe: Recipe, place: Sequence[float]) -> Equations:
    loaded = recipe.scenario(place, "probe")
    return Derived(loaded, build_subject(loaded)).equations


def _identity(equations: Equations) -> tuple[str, ...]:
    return (fingerprint(equations), *(table.digest for table in equations.tables))


def _template(recipe: Recipe, values: Sequence[float]) -> LoadedScenario:
    pairs = [(a, v) for a, v in zip(recipe.axes, values, strict=True) if a.is_choice]
    only = replace(recipe, axes=tuple(axis for axis, _ in pairs))
    try:
        return only.scenario([value for _, value in pairs], "the cases' scenario")
    except InputError:
        return recipe.scenario(values, "the first case")


def _parameters_of(subject: Subject, prepared: Prepared) -> Vector:
    known = {entry.name: entry.value for entry in subject.system.table.entries}
    names = [parameter.name for parameter in prepared.equations.parameters]
    try:
        return np.array([known[name] for name in names])
    except KeyError as error:
        raise InputError(f"this case has no parameter {error}; its equations are others") from None


def _find_shortcut(
    recipe: Recipe, values: Sequence[float], prepared: Prepared, reference: RestPoint | None
) -> Shortcut | None:
    """Return where parameters that vary stand in scenarios, None if more than these vary.

    Found by building the scenario at two places inside the ranges and at the case itself.
    """
    try:
        places = [_probe(recipe.axes, values, number) for number in _PROBES]
        scenarios = [recipe.scenario(place, "probe") for place in (*places, values)]
        subjects = [build_subject(scenario) for scenario in scenarios]
        tables = np.array([_parameters_of(subject, prepared) for subject in subjects])
    except VehicledynError:
        return None
    varying = np.flatnonzero((tables[0] != tables[1]) | (tables[0] != tables[2])).tolist()
    named = _leaf_by_values(scenarios)
    paths = [named.get(tuple(tables[:, index].tolist())) for index in varying]
    # The template's own start counts, too: an axis of a single value differs from nothing else.
    starts = [_held(subject, prepared, reference) for subject in (*subjects, prepared.subject)]
    exact = (
        None not in paths
        and all(np.array_equal(start, starts[0]) for start in starts)
        and len({_shape(subject) for subject in [*subjects, prepared.subject]}) == 1
    )
    known = tuple(path for path in paths if path is not None)
    return Shortcut(tables[2], tuple(varying), known) if exact else None


def _leaf_by_values(
    scenarios: Sequence[LoadedScenario],
) -> dict[tuple[float, ...], tuple[str, ...]]:
    """Return where a number stands that has these values in the scenarios."""
    tables = [dict(leaves(scenario.resolved)) for scenario in scenarios]
    return {
        tuple(float(table[path]) for table in tables): path
        for path, value in tables[0].items()
        if isinstance(value, float) and all(isinstance(t.get(path), float) for t in tables)
    }


def _at(data: Any, path: tuple[str, ...]) -> float:
    for step in path:
        data = data[int(step)] if isinstance(data, list) else data[step]
    return float(data)


def _probe(axes: Sequence[Axis], values: Sequence[float], number: int) -> list[float]:
    """Return a place inside the ranges of the axes, no two of which have the same value."""
    index, found = np.array([number]), []
    for column, (axis, value) in enumerate(zip(axes, values, strict=True)):
        if axis.is_choice:
            found.append(float(value))
            continue
        low, high = (min(axis.values), max(axis.values)) if axis.values else (axis.low, axis.high)
        found.append(low + (high - low) * float(scatter.uniform(0, column, index)[0]))
    return found


def _held(subject: Subject, prepared: Prepared, reference: RestPoint | None) -> Vector:
    """Return the part of a start that does not follow from the balance, at one speed."""
    equations = starting_at(prepared.equations, prepared.subject, subject)
    rates = [subject.given_rates.get(joint.name, 0.0) for joint in subject.system.joints()]
    starts = [subject.start_state(equations, speed) for speed in (0.0, 1.0)]
    kept = np.ones(len(equations.states), dtype=bool)
    if reference is not None:
        kept[reference.free] = False
        kept[list(equations.speeds)] = True
        spun = [k for k in reference.free if k in equations.velocities]
        kept[spun] = False
    guesses = [u.start for u in equations.unknowns]
    return np.concatenate([*(start[kept] for start in starts), rates, guesses])


def _shape(subject: Subject) -> tuple[Any, ...]:
    """Return what key figures read of a model besides its manoeuvre."""
    return (subject.shapes(), subject.ports.body, subject.ports.steering, subject.ports.wheels)


def _silent(what: str, part: float | None) -> None:
    """Show nothing."""
