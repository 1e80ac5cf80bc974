"""Derivatives of limit cycles and of the non-linear critical speed by all parameters."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.periodic.collocation import Direction
from vehicledyn.analyse.periodic.cycle_points import Branch, CyclePoint, moved
from vehicledyn.analyse.periodic.cycles_at import cycle_beside, points_beside
from vehicledyn.analyse.periodic.fine_orbits import FineOrbits
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.analyse.periodic.orbit_slopes import OrbitSlopes, ParameterSlopes, orbit_slopes
from vehicledyn.analyse.settling.cached_types import CYCLE_KINDS
from vehicledyn.analyses.hunting.bent_motions import bent_motions
from vehicledyn.analyses.hunting.critical_values import lowest_stable
from vehicledyn.analyses.hunting.parameter_starts import ParameterStarts
from vehicledyn.analyses.hunting.refusals import check_subject
from vehicledyn.analyses.hunting.start import SPEED, HuntSettings, balanced_point
from vehicledyn.analyses.hunting.study import Study
from vehicledyn.analyses.hunting.undisturbed import without_disturbances
from vehicledyn.analyses.linear.written_starts import WrittenStarts
from vehicledyn.analyses.preparation.own_speed import own_speed
from vehicledyn.analyses.preparation.prepare import prepare
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.analyses.sensitivity.cycle_figures import CycleFigures
from vehicledyn.analyses.sensitivity.figure_kinds import (
    CYCLE_FIGURE,
    CYCLE_WORDS,
    NONLINEAR,
)
from vehicledyn.analyses.sensitivity.names import directions
from vehicledyn.base.errors import InputError, NumericalError, unknown_name
from vehicledyn.base.step_memory import Memory
from vehicledyn.files.scenario.target import Target
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.sensitivity_table import SensitivityTable
from vehicledyn.symbolic.equations import Equations

Floats = NDArray[np.float64]

_BESIDE = 0.9, 1.1
"""Range round the speed at which branches are looked for, parts of it."""
_BELOW, _ABOVE = 0.4, 1.1
"""Range in which the lowest stable cycle is looked for, parts of the linear critical speed."""

_MOST_INTERVALS = 2560
_CONVERGED, _TOLERATED = 1e-7, 1e-4
"""Change of effects with half the mesh, part of the largest one, with which the mesh suffices, and
above which a note says so."""
_OF_ITSELF, _SMALL = 1e-6, 1e-3
"""Change of an effect, part of itself, with which the mesh suffices; part of the largest effect
below which an effect is not measured by itself, and of a figure below which none is."""


KINDS = *CYCLE_KINDS, OrbitSlopes
"""Results of steps that a memory knows."""


@dataclass(frozen=True)
class _Asked:
    """A name, its kind and the index of its channel."""

    name: str
    kind: str
    channel: int | None


def find_cycle_sensitivity(
    target: Target,
    of: Sequence[str],
    to: Sequence[str],
    speed: float | None,
    progress: Progress,
    *,
    memory: Memory,
) -> SensitivityTable:
    """Return derivatives of limit cycles at a speed, or of the lowest speed that has stable ones.

    Parameters
    ----------
    target
        A scenario or model with a parameter "speed".
    of
        ``cycle_period``, ``cycle_frequency``, ``cycle_amplitude(CHANNEL)``, half the range,
        ``cycle_max``, ``cycle_min``, ``cycle_mean`` and ``cycle_rms`` of channels, and
        ``nonlinear_critical_speed``.
    to
        Patterns of parameters.
    speed
        Forward speed [m/s] of the cycles, and where the search begins; the target's own if None.
    progress
        Called with what is going on.
    memory
        Knows results of :data:`KINDS`.

    Raises
    ------
    InputError
        If a name means nothing, or the model has no speed.
    NumericalError
        If there is no cycle, or its derivative does not exist.
    """
    if any(name.startswith("start.") for name in to):
        raise InputError("a limit cycle has no start values; name parameters")
    value = own_speed(target) if speed is None else speed
    if value is None and target.choices is not None:
        value = target.choices.speed
    if value is None or not value > 0.0:
        raise InputError("limit cycles need a speed above zero; give one")
    low, high = (part * value for part in _BESIDE)
    found = _Cycles.of(target, (low, high), progress, memory)
    e = found.study.prepared.equations
    asked = [_parsed(name, e) for name in of]
    chosen = directions(e, found.study.model.parameters(value), found.start, to)
    which = [int(k) for k in chosen.by_parameter.argmax(axis=0)]
    rows: list[tuple[Quantity, float, Floats]] = []
    if any(item.kind != NONLINEAR for item in asked):
        rows += found.at(value, [item for item in asked if item.kind != NONLINEAR], which)
    if any(item.kind == NONLINEAR for item in asked):
        rows.append(found.nonlinear_critical(which))
    return SensitivityTable(
        target.title,
        e.name,
        chosen.quantities,
        chosen.values,
        tuple(quantity for quantity, _, _ in rows),
        np.array([number for _, number, _ in rows]),
        np.array([slope for _, _, slope in rows]),
        notes=tuple(dict.fromkeys(found.notes)),
    )


@dataclass
class _Cycles:
    """The hunting study that finds cycles, its target, and notes for the user."""

    target: Target
    study: Study
    progress: Progress
    memory: Memory
    notes: list[str]

    @staticmethod
    def of(
        target: Target, span: tuple[float, float], progress: Progress, memory: Memory
    ) -> _Cycles:
        """Return the study of a range of speeds [m/s], equilibria alone."""
        settings = HuntSettings(SPEED, *span, simulate=False)
        target, remarks = without_disturbances(target, settings)
        prepared = prepare(
            target,
            backend="auto",
            progress=progress,
            check=lambda derived: check_subject(derived, settings),
            varies_states=True,
            evaluations=math.inf,
        )
        study = Study.of(prepared, target, settings, progress)
        study.model.memory = memory
        return _Cycles(target, study, progress, memory, list(remarks))

    @property
    def start(self) -> Floats:
        """Start values of all states."""
        return np.array([s.start for s in self.study.prepared.equations.states])

    def at(
        self, value: float, asked: Sequence[_Asked], which: Sequence[int]
    ) -> Iterator[tuple[Quantity, float, Floats]]:
        """Yield figures of all cycles at a speed, the smallest first, with their derivatives."""
        study = self.study
        study.examine()
        cycles = [
            cycle_beside(study.model, near, value)
            for branch in study.branches
            for near in points_beside(branch, value)
        ]
        if not cycles:
            why = "; ".join(["", *study.messages])
            raise NumericalError(f"no limit cycle is found at {value:g} m/s{why}")
        self.notes += study.messages
        self.notes += bent_motions(study.prepared, study.model, [], [Branch(cycles)])
        cycles.sort(key=lambda point: float(np.abs(np.ptp(point.orbit.states, axis=0)).sum()))
        channels = sorted({item.channel for item in asked if item.channel is not None})
        slopes = ParameterSlopes(study.model, which, channels, self._held(value))
        e = study.prepared.equations
        for place in slopes.going_on(cycles[0].orbit):
            raise InputError(
                f"'{e.channels[channels[place]].name}' has no period: it follows time or a state "
                "that no rate depends on and that the limit cycle does not repeat, such as a way "
                "travelled; ask for its rate or for another channel"
            )
        places = [None if k.channel is None else channels.index(k.channel) for k in asked]
        judged = list(zip([item.kind for item in asked], places, strict=True))
        for number, cycle in enumerate(cycles, 1):
            self.progress(f"differentiating limit cycle {number} of {len(cycles)}", None)
            figures = self._settled(cycle, slopes, judged)
            state = "stable" if cycle.stable else "unstable"
            for item in asked:
                label = f"cycle_{number}.{item.name.removeprefix('cycle_')}"
                words = f"of the {state} limit cycle {number} at {value:g} m/s"
                if item.channel is None:
                    unit = "s" if item.kind == "cycle_period" else "Hz"
                    what = item.kind.removeprefix("cycle_").capitalize()
                    yield Quantity(label, unit, f"{what} {words}"), *figures.whole(item.kind)
                    continue
                channel = e.channels[item.channel]
                what = CYCLE_WORDS[item.kind].format(channel.name)
                own = figures.of_channel(item.kind, channels.index(item.channel))
                yield Quantity(label, channel.unit, f"{what} {words}"), *own

    def _held(self, value: float) -> Floats:
        """Let states that no rate depends on stand where they start at a speed; return its slopes.

        Their derivatives by all parameters, shape (n_states, n_parameters).
        """
        prepared, model = self.study.prepared, self.study.model
        written, parameters = WrittenStarts(prepared, value), model.parameters(value)
        if set(written.states).difference(model.kept):
            begun = ParameterStarts(prepared, self.target, SPEED).at(value)
            begun.kernel.set_parameters(parameters)
            model.reduced(balanced_point(begun, SPEED, value, self.target.choices, model).state)
        return written.slopes(parameters)

    def nonlinear_critical(self, which: Sequence[int]) -> tuple[Quantity, float, Floats]:
        """Return the lowest speed with a stable cycle, where that is a fold, and its slopes."""
        study = self.study
        if not study.balances:
            study.follow_equilibria()
        hopfs = [hopf.balance.value for hopf in study.hopfs]
        if not hopfs:
            why = "; ".join(["", *study.messages])
            raise NumericalError(f"no oscillation begins to grow near the speed{why}")
        low, high = _BELOW * min(hopfs), _ABOVE * min(hopfs)
        settings = HuntSettings(SPEED, low, high, simulate=False)
        wide = Study.of(study.prepared, self.target, settings, self.progress)
        wide.model.memory = self.memory
        wide.examine()
        self.notes += wide.messages
        self.study = wide
        lowest = lowest_stable(wide.branches, wide.span)
        if lowest is None:
            why = "; ".join(["", *wide.messages])
            raise NumericalError(f"no stable cycle between {low:g} and {high:g} m/s{why}")
        value, kind = lowest
        folds = [
            point
            for branch in wide.branches
            for point in branch.points
            if point.kind == "fold" and point.orbit.parameter == value
        ]
        if not folds:
            raise NumericalError(
                f"the lowest stable cycle, at {value:.6g} m/s, is no fold ({kind}): its speed has "
                "no derivative of this kind; ask for 'critical_speed' or look at it with 'hunt'"
            )
        return self._fold(folds[0], which)

    def _settled(
        self, cycle: CyclePoint, slopes: ParameterSlopes, judged: Sequence[tuple[str, int | None]]
    ) -> CycleFigures:
        """Return the figures of a cycle on a mesh on which derivatives of some no longer change.

        These are given by kind and, where they are of a channel, its number among those asked for.
        """
        orbits, orbit = FineOrbits(slopes.field, slopes.asked), cycle.orbit
        values = slopes.field.values[slopes.which]
        before: Floats | None = None
        while True:
            find = partial(_differentiated, slopes, orbits, orbit)
            orbit, along = self.memory.recall_or_raise("differentiated", orbit, find)
            figures = CycleFigures(slopes, orbit, along)
            found = np.array([figures.of(*item)[1] for item in judged])
            if before is not None:
                sizes = np.array([figures.size(*item) for item in judged])
                if self._is_settled(_changes(before, found, values, sizes), orbit):
                    return figures
            before, orbit = found, orbits.finer(orbit)

    def _fold(self, point: CyclePoint, which: Sequence[int]) -> tuple[Quantity, float, Floats]:
        """Return the speed of a fold and its slopes, on the plane across the branch."""
        model = self.study.model
        orbits, slopes = FineOrbits(model), ParameterSlopes(model, which)
        orbit, along, values = point.orbit, point.tangent, model.values[list(which)]
        before: Floats | None = None
        while True:
            find = partial(_differentiated_fold, slopes, orbits, orbit, along)
            orbit, way, slope = self.memory.recall_or_raise("fold", (orbit, along), find)
            if model.index in which:
                slope[list(which).index(model.index)] = 0.0
            if before is not None and self._is_settled(
                _changes(before, slope, values, abs(orbit.parameter)), orbit
            ):
                break
            before, finer = slope, orbits.finer(orbit)
            along, orbit = moved(orbit, way, finer.mesh), finer
        words = "Lowest speed with a stable limit cycle, at a fold"
        return Quantity(NONLINEAR, "m/s", words), orbit.parameter, slope

    def _is_settled(self, changes: tuple[float, float], orbit: Orbit) -> bool:
        """Return whether a mesh is fine enough; say so if it is as fine as it may be but not."""
        change, of_itself = changes
        if change < _CONVERGED and of_itself < _OF_ITSELF:
            return True
        if 2 * orbit.intervals <= _MOST_INTERVALS:
            return False
        if change > _TOLERATED:
            self.notes.append(
                f"effects of parameters still change by {change:.1g} of the largest with twice as "
                "fine a mesh, about their error: the motion has corners, as where contacts "
                "begin or jump, or where profiles given by tables pass from cubic to cubic"
            )
        return True


def _differentiated(
    slopes: ParameterSlopes, orbits: FineOrbits, guess: Orbit
) -> tuple[Orbit, OrbitSlopes]:
    """Return the orbit near a guess and how it follows the parameters."""
    fine = orbits.at(guess)
    return fine.found.orbit, orbit_slopes(slopes, fine)


def _differentiated_fold(
    slopes: ParameterSlopes, orbits: FineOrbits, guess: Orbit, along: Direction
) -> tuple[Orbit, Direction, Floats]:
    """Return the orbit at a fold, the direction there, and how its parameter follows others."""
    fine = orbits.fold(guess, along)
    assert fine.along is not None
    return fine.found.orbit, fine.along, orbit_slopes(slopes, fine).parameter


def _changes(
    before: Floats, after: Floats, values: Floats, sizes: Floats | float
) -> tuple[float, float]:
    """Return by how much effects of parameters differ: part of the largest of a row, of themselves.

    Effects are derivatives (..., n) times the parameters' values (n,); what is small beside the
    ``sizes`` (...,) of the figures is none, such as the mean of what swings evenly to both sides.
    """
    effects, missed = np.abs(after * values), np.abs((after - before) * values)
    least = np.maximum(_SMALL * np.asarray(sizes), np.finfo(float).tiny)[..., None]
    largest = np.maximum(effects.max(axis=-1, keepdims=True), least)
    own = np.maximum(np.maximum(effects, _SMALL * largest), least)
    return float((missed / largest).max(initial=0.0)), float((missed / own).max(initial=0.0))


def _parsed(name: str, equations: Equations) -> _Asked:
    """Return what a name asks for.

    Raises
    ------
    InputError
        If there is no such channel.
    """
    match = CYCLE_FIGURE.fullmatch(name)
    if match is None:
        return _Asked(name, name, None)
    channels = [c.name for c in equations.channels]
    if match[2].strip() not in channels:
        raise InputError(f"'{name}': {unknown_name('channel', match[2].strip(), channels)}")
    return _Asked(name, match[1], channels.index(match[2].strip()))
