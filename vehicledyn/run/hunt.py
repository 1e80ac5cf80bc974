"""The verb "hunt": where a motion begins to oscillate, and the limit cycles it then has."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError, NumericalError, nearest_name, unknown_name
from vehicledyn.base.units import to_si
from vehicledyn.results.hunt_figures import hunt_figures
from vehicledyn.results.hunt_table import CycleRow, HuntTable, write_hunt
from vehicledyn.results.linear_file import Quantity
from vehicledyn.results.output import check_folder, check_output
from vehicledyn.results.pictures import save_figures
from vehicledyn.run.hunt_report import HuntReport
from vehicledyn.run.prepare import Prepared, Progress, prepare, reference_point
from vehicledyn.run.system_subject import SystemSubject
from vehicledyn.run.vehicle import Target
from vehicledyn.scenario import LoadedScenario, Scenario
from vehicledyn.solve.kernel import Backend
from vehicledyn.solve.periodic.autonomous import AutonomousField
from vehicledyn.solve.periodic.branch import follow_cycles
from vehicledyn.solve.periodic.collocation import Direction
from vehicledyn.solve.periodic.critical import (
    Balance,
    Hopf,
    ahead,
    find_balance,
    find_hopf,
    follow_balance,
)
from vehicledyn.solve.periodic.cycle_points import Branch, CyclePoint, Limits
from vehicledyn.solve.periodic.cycles_at import cycle_at
from vehicledyn.solve.periodic.orbit import Orbit
from vehicledyn.solve.periodic.settled import (
    Runner,
    Settled,
    balances_near,
    growth_begins,
    leading,
    lower,
    steps,
)

Vector = NDArray[np.float64]

DEGREE = 4
_PHASES = 101
_MOST_CHANNELS = 8
_LEAST_CYCLES = 80
"""Cycles that a branch may have at least, however few are asked for."""

SPEED = "speed"
"""Parameter that has to be above zero [m/s]."""

_LOW_SPEED = 1.0

_APPROACH = 20
"""Values at which an equilibrium is followed from a file's own value to the first one."""

_BEHIND = 4
"""Points an interval at which the range of a channel is looked for."""


@dataclass(frozen=True)
class HuntSettings:
    """What is asked of a study.

    ``parameter`` goes from ``first`` up to ``last``, numbers in SI or texts with unit;
    ``points`` is about the number of cycles of a branch; ``channels`` are watched, the first
    one for the amplitude. ``amplitude`` is the size of the first cycle at a Hopf bifurcation
    and ``disturbance`` that with which simulations start, both of the position that moves
    most, in its unit. ``simulate`` asks for the check by simulation in ``levels`` steps.
    """

    parameter: str
    first: float | str
    last: float | str
    points: int = 60
    channels: tuple[str, ...] = ()
    amplitude: float = 1e-4
    disturbance: float = 1e-3
    intervals: int = 30
    simulate: bool = True
    levels: int = 13


def find_limit_cycles(
    target: Target,
    settings: HuntSettings,
    *,
    backend: Backend,
    output: Path | None = None,
    plots: Path | None = None,
    progress: Progress,
) -> HuntReport:
    """Return where a motion begins to oscillate and the limit cycles along a parameter.

    Parameters
    ----------
    target
        A scenario or a model.
    settings
        What is asked.
    backend, progress
        As for a run.
    output
        Result file to write.
    plots
        Folder for the figures.

    Raises
    ------
    InputError
        If the parameter, its range or a channel is not usable, or a file cannot be written.
    NumericalError
        If there is no equilibrium at the first value.
    """
    if output is not None:
        check_output(output)
    if plots is not None:
        check_folder(plots)
    _check(settings)
    prepared = prepare(target, backend=backend, progress=progress)
    study = _Study.of(prepared, target, settings, progress)
    study.examine()
    table = study.table()
    if output is not None:
        write_hunt(output, table)
    if plots is not None:
        progress("drawing", None)
        save_figures(hunt_figures(table), plots, ("png", "svg"))
    return HuntReport(table, tuple(study.messages), study.exit_code)


@dataclass
class _Study:
    """A study while it is made; what was found is kept whatever comes."""

    prepared: Prepared
    settings: HuntSettings
    model: AutonomousField
    title: str
    watched: list[int]
    progress: Progress
    span: tuple[float, float]
    start: tuple[Vector, Vector]
    balances: list[Balance] = field(default_factory=list)
    hopfs: list[Hopf] = field(default_factory=list)
    branches: list[Branch] = field(default_factory=list)
    simulated: list[Settled] = field(default_factory=list)
    figures: dict[str, float] = field(default_factory=dict)
    messages: list[str] = field(default_factory=list)
    exit_code: int = 0
    status: str = "ok"

    @staticmethod
    def of(
        prepared: Prepared, target: Target, settings: HuntSettings, progress: Progress
    ) -> _Study:
        """Return a study at its beginning: the equilibrium near the first value."""
        index = _parameter_index(prepared, settings.parameter)
        span = _span(prepared, index, settings)
        scenario = target.scenario if isinstance(target, LoadedScenario) else None
        progress("finding the equilibrium", None)
        model, start = _first_balance(prepared, index, span[0], scenario)
        title = scenario.title if scenario else prepared.equations.name
        return _Study(
            prepared,
            settings,
            model,
            title,
            _watched(prepared, settings.channels),
            progress,
            span,
            start,
        )

    def examine(self) -> None:
        """Follow equilibria and cycles, and check them by simulation."""
        try:
            self._equilibria()
            self._cycles()
            if self.settings.simulate:
                self._simulations()
        except KeyboardInterrupt:
            self._ended("interrupted", 130, "stopped by the user; what was found is kept")
        except NumericalError as error:
            if not self.balances:
                raise NumericalError(
                    f"{error}; a motion whose speed slowly falls is not steady either"
                ) from None
            self._ended("failed", 3, f"{error}; what was found is kept")
        self._figures()

    def table(self) -> HuntTable:
        """Return everything that was found."""
        e = self.prepared.equations
        entry = e.parameters[self.model.index]
        eigenvalues = [b.eigenvalues for b in self.balances]
        rows = [
            self._row(number, point)
            for number, branch in enumerate(self.branches, 1)
            for point in branch.points
        ]
        return HuntTable(
            self.title,
            e.name,
            Quantity(entry.name, entry.unit, entry.description),
            tuple(
                Quantity(e.channels[k].name, e.channels[k].unit, e.channels[k].description)
                for k in self.watched
            ),
            np.array([b.value for b in self.balances]),
            np.array(eigenvalues, dtype=complex).reshape(len(eigenvalues), self.model.size),
            tuple(rows),
            np.array([[s.value, s.amplitude, s.period] for s in self.simulated]).reshape(-1, 3),
            self.figures,
            self.status,
            "; ".join(self.messages),
        )

    def _equilibria(self) -> None:
        s = self.settings
        state, unknowns = self.start
        for k, value in enumerate(np.linspace(*self.span, max(s.points, 20))):
            self.progress("following the equilibrium", k / max(s.points, 20))
            if self.balances:
                state, unknowns = ahead(self.model, self.balances[-1], float(value))
            try:
                found = find_balance(self.model, float(value), state, unknowns)
            except NumericalError as error:
                if not self.balances:
                    raise
                self._ended("partial", 3, f"{error}; the equilibrium is followed up to there")
                break
            self.balances.append(found)
        self.hopfs = find_hopf(self.model, self.balances)

    def _cycles(self) -> None:
        s = self.settings
        if self.hopfs and not s.channels:
            self._watch_first(leading(self.model, self.hopfs[0].shape))
        for hopf in self.hopfs:
            if any(self._reaches(branch, hopf) for branch in self.branches):
                continue
            index = leading(self.model, hopf.shape)
            start = hopf.orbit(s.amplitude, index, intervals=s.intervals, degree=DEGREE)
            self._follow(start, hopf.growing(start), f"from {hopf.balance.value:.6g}")

    def _watch_first(self, index: int) -> None:
        """Put the channel of a state, where it has one, before the others."""
        names = [c.name for c in self.prepared.equations.channels]
        name = self.model.names[index]
        if name in names:
            first = names.index(name)
            self.watched = [first, *(k for k in self.watched if k != first)]

    def _follow(
        self, start: Orbit, direction: Direction | None, place: str, upwards: bool = True
    ) -> None:
        low, high = self.span
        points = self.settings.points
        branch = Branch()
        self.branches.append(branch)
        limits = Limits(low, high, (high - low) / points, points=max(points + 20, _LEAST_CYCLES))

        def told(point: CyclePoint) -> None:
            part = (point.orbit.parameter - low) / (high - low)
            self.progress(f"following the limit cycles {place}", min(1.0, max(0.0, part)))

        follow_cycles(
            self.model,
            start,
            direction,
            limits,
            branch=branch,
            told=told,
            upwards=upwards,
        )
        name = f"branch {len(self.branches)}"
        self.messages.extend(f"{name}: {remark}" for remark in branch.remarks)
        if branch.ending == "lost":
            self._ended("partial", 3, f"{name}: {branch.reason}")
        if branch.ending == "points":
            self.messages.append(f"{name}: {branch.reason}; it goes on, raise --points")

    def _reaches(self, branch: Branch, hopf: Hopf) -> bool:
        """Return whether a branch ended at a Hopf bifurcation."""
        if branch.ending != "equilibrium" or not branch.points:
            return False
        end = branch.points[-1].orbit.parameter
        return abs(end - hopf.balance.value) < 1e-2 * (self.span[1] - self.span[0])

    def _simulations(self) -> None:
        s = self.settings
        if not any(np.any(b.eigenvalues.imag != 0.0) for b in self.balances):
            return
        runner = Runner(self.prepared.kernel, self.model, self.watched[0])
        near = balances_near(self.model, self.balances)
        resolution = 2e-4 * (self.span[1] - self.span[0])
        self.progress("lowering the parameter in simulations", None)
        high = self.balances[-1].value
        found = lower(
            runner,
            list(steps(high, self.span[0], s.levels)),
            near,
            s.disturbance,
            resolution=resolution,
            told=self._simulated,
        )
        if found is not None:
            self.figures["simulated_lowering"] = 0.5 * sum(found)
        if self.simulated and not any(branch.points for branch in self.branches):
            self._from_simulation(self.simulated[0])
        self.progress("raising the parameter in simulations", None)
        grown = growth_begins(
            runner,
            list(steps(self.span[0], high, s.levels)),
            near,
            s.amplitude,
            resolution=resolution,
        )
        if grown is not None:
            self.figures["simulated_raising"] = 0.5 * sum(grown)

    def _from_simulation(self, found: Settled) -> None:
        """Follow the cycle that a simulation settled to, to both sides."""
        s = self.settings
        start = found.orbit(self.model, intervals=s.intervals, degree=DEGREE)
        self._follow(start, None, "down from the simulated one", upwards=False)

    def _simulated(self, found: Settled) -> None:
        self.simulated.append(found)

    def _figures(self) -> None:
        """Note the critical values, and how far simulation and continuation differ."""
        begins = [h.balance.value for h in self.hopfs if h.begins]
        if begins:
            self.figures["linear_critical"] = min(begins)
            self.figures["linear_critical_frequency"] = next(
                h.frequency / (2.0 * math.pi) for h in self.hopfs if h.balance.value == min(begins)
            )
        folds = [p.orbit.parameter for b in self.branches for p in b.special if p.kind == "fold"]
        stable = [p.orbit.parameter for b in self.branches for p in b.points if p.stable]
        if stable:
            lowest = min(stable)
            nearest = min(folds, key=lambda v: abs(v - lowest), default=lowest)
            self.figures["nonlinear_critical"] = min(lowest, nearest)
        differences = [self._difference(s) for s in self.simulated]
        known = [d for d in differences if d is not None]
        if known:
            self.figures["largest_difference_amplitude"] = max(d[0] for d in known)
            self.figures["largest_difference_period"] = max(d[1] for d in known)

    def _difference(self, found: Settled) -> tuple[float, float] | None:
        """Return relative differences of amplitude and period to the nearest stable cycle."""
        best: tuple[float, float] | None = None
        for branch in self.branches:
            try:
                cycles = [c for c in cycle_at(self.model, branch, found.value) if c.stable]
            except NumericalError:
                continue
            for cycle in cycles:
                row = self._row(0, cycle)
                size = abs(found.amplitude / float(row.amplitude[0]) - 1.0)
                if best is None or size < best[0]:
                    best = size, abs(found.period / row.period - 1.0)
        return best

    def _row(self, number: int, point: CyclePoint) -> CycleRow:
        """Return a cycle with the motion of the watched channels."""
        orbit = point.orbit
        widths = orbit.widths[:, None]
        places = (orbit.mesh[:-1, None] + widths * np.arange(_BEHIND) / _BEHIND).ravel()
        values = self._channels(point, places)
        even = np.linspace(0.0, 1.0, _PHASES)
        motion = self._channels(point, even % 1.0)
        return CycleRow(
            number,
            orbit.parameter,
            orbit.period,
            point.stable,
            point.kind,
            point.multipliers.trivial,
            point.multipliers.all,
            -np.array([_top(places, -column) for column in values.T]),
            np.array([_top(places, column) for column in values.T]),
            motion,
        )

    def _channels(self, point: CyclePoint, places: Vector) -> Vector:
        kernel = self.prepared.kernel.with_parameters(self.model.parameters(point.orbit.parameter))
        states, unknowns = point.orbit.sample(places)
        rows = []
        for state, guess in zip(self.model.full(states), unknowns, strict=True):
            solved = kernel.solve_unknowns(0.0, state, guess) if guess.size else guess
            rows.append(kernel.outputs(0.0, state, solved)[self.watched])
        return np.array(rows)

    def _ended(self, status: str, exit_code: int, message: str) -> None:
        self.status, self.exit_code = status, exit_code
        self.messages.append(message)


def _first_balance(
    prepared: Prepared, index: int, first: float, scenario: Scenario | None
) -> tuple[AutonomousField, tuple[Vector, Vector]]:
    """Return the field and the equilibrium, states kept and unknowns, at the first value.

    Start values of a file, as the rate of a wheel that rolls, belong to the file's own value of
    the parameter. Where the search from there fails the equilibrium is followed from that value.
    """
    name = prepared.equations.parameters[index].name
    own = float(prepared.kernel.parameters[index])
    try:
        model, start = _balance_at(prepared, index, first, scenario)
    except NumericalError as error:
        reason = NumericalError(f"{name} = {first:.6g}: {error}")
        if own == first:
            raise reason from None
        try:
            model, (state, unknowns) = _balance_at(prepared, index, own, scenario)
            values = list(steps(own, first, _APPROACH))
            found = follow_balance(model, values, state, unknowns)[-1]
        except NumericalError:
            raise reason from None
        start = found.state, found.unknowns
    return model, start


def _balance_at(
    prepared: Prepared, index: int, value: float, scenario: Scenario | None
) -> tuple[AutonomousField, tuple[Vector, Vector]]:
    """Return the field and the equilibrium at a value, as searched from the start values."""
    name = prepared.equations.parameters[index].name
    values = prepared.kernel.parameters.copy()
    values[index] = value
    prepared.kernel.set_parameters(values)
    model = AutonomousField(prepared.equations, name, values)
    is_system = isinstance(prepared.subject, SystemSubject)
    point = reference_point(
        prepared,
        value if name == "speed" else (scenario.speed or 0.0 if scenario else 0.0),
        scenario.start if scenario else None,
        is_system=is_system,
        slopes=model if is_system else None,
    )
    return model, (model.reduced(point.state), point.unknowns)


def _top(places: Vector, values: Vector) -> float:
    """Return the largest value of a periodic channel, with a parabola through neighbours."""
    k = int(np.argmax(values))
    around = [k - 1, k, (k + 1) % len(values)]
    x = places[around] - places[k]
    x[0] -= 1.0 if x[0] > 0.0 else 0.0
    x[2] += 1.0 if x[2] < 0.0 else 0.0
    y = values[around]
    a, b, c = np.polyfit(x / x[2], y, 2)
    top = float(c - b * b / (4.0 * a)) if a < 0.0 else float(values[k])
    return top if float(values[k]) <= top < float(values[k]) + np.ptp(values) else float(values[k])


def _check(settings: HuntSettings) -> None:
    s = settings
    if s.points < 2 or s.intervals < 5:
        raise InputError("--points must be at least 2, and --intervals at least 5")
    if not (s.amplitude > 0.0 and s.disturbance > 0.0):
        raise InputError("--amplitude and --disturbance must be above zero")


def _parameter_index(prepared: Prepared, name: str) -> int:
    names = [p.name for p in prepared.equations.parameters]
    if name in names:
        return names.index(name)
    guess = nearest_name(name, names)
    hint = f"; did you mean '{guess}'?" if guess else ""
    raise InputError(
        f"--parameter {name}: '{prepared.equations.name}' has no parameter of this name{hint} "
        "(a speed is one only where the model prescribes it); 'models show' lists them"
    )


def _span(prepared: Prepared, index: int, settings: HuntSettings) -> tuple[float, float]:
    """Return the range in SI."""
    unit = prepared.equations.parameters[index].unit
    values = []
    for option, given in (("--from", settings.first), ("--to", settings.last)):
        try:
            values.append(to_si(given, unit))
        except InputError as error:
            raise InputError(f"{option} {given}: {error}") from None
    low, high = values
    asked = f"--from {settings.first} --to {settings.last}"
    if not (math.isfinite(low) and math.isfinite(high)):
        raise InputError(f"{asked}: both must be finite")
    if not low < high:
        hint = "exchange them" if low > high else "they are equal: 'eig' looks at a single value"
        raise InputError(f"{asked}: the first must be below the last; {hint}")
    if settings.parameter.rpartition(".")[2] == SPEED and low <= 0.0:
        raise InputError(
            f"--from {settings.first}: a {settings.parameter} of zero or below is none to roll at, "
            f"creepages are divided by it; begin above zero, such as --from '{_LOW_SPEED:g} m/s'"
        )
    return low, high


def _watched(prepared: Prepared, wanted: Sequence[str]) -> list[int]:
    """Return the channels to watch: those asked for, else the coordinates."""
    names = [c.name for c in prepared.equations.channels]
    for name in wanted:
        if name not in names:
            raise InputError(f"--channel {unknown_name('channel', name, names)}")
    chosen = list(wanted)
    if not chosen:
        joints = [j.name for j in prepared.subject.system.joints() if j.name in names]
        states = {s.name for s in prepared.equations.states}
        chosen = [n for n in joints if n in states][:_MOST_CHANNELS] or joints[:_MOST_CHANNELS]
    if not chosen:
        raise InputError("--channel: missing: name a channel to watch")
    return [names.index(name) for name in dict.fromkeys(chosen)]
