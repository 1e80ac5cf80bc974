"""The verb "hunt": where a motion begins to oscillate, and the limit cycles it then has."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import NumericalError
from vehicledyn.results.hunt_figures import hunt_figures
from vehicledyn.results.hunt_table import CycleRow, HuntTable, write_hunt
from vehicledyn.results.linear_file import Quantity
from vehicledyn.results.output import check_folder, check_output
from vehicledyn.results.pictures import save_figures
from vehicledyn.run.hunt_report import HuntReport
from vehicledyn.run.hunt_start import (
    HuntSettings,
    check_settings,
    first_balance,
    parameter_index,
    span_of,
    watched_channels,
)
from vehicledyn.run.prepare import Prepared, Progress, prepare
from vehicledyn.run.vehicle import Target
from vehicledyn.scenario import LoadedScenario
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
)
from vehicledyn.solve.periodic.cycle_points import Branch, CyclePoint, Limits
from vehicledyn.solve.periodic.cycles_at import cycle_beside, points_beside
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
_LEAST_CYCLES, _PASSES = 120, 3
"""Cycles that a branch may have at least, and how often it may pass the range."""

_SAME = 0.05
"""Relative difference of amplitudes below which a simulated cycle is one of a branch."""

_BESIDE = 2e-3
"""Relative distance of values at which cycles count as neighbours, as beside a fold."""

_FURTHER_BRANCHES = 3
"""Branches that are begun at simulated cycles at most."""

_BEHIND = 4
"""Points an interval at which the range of a channel is looked for."""


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
    check_settings(settings)
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
        index = parameter_index(prepared, settings.parameter)
        span = span_of(prepared, index, settings)
        scenario = target.scenario if isinstance(target, LoadedScenario) else None
        progress("finding the equilibrium", None)
        model, start = first_balance(prepared, index, span[0], scenario)
        title = scenario.title if scenario else prepared.equations.name
        return _Study(
            prepared,
            settings,
            model,
            title,
            watched_channels(prepared, settings.channels),
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
    ) -> Branch:
        low, high = self.span
        points = self.settings.points
        branch = Branch()
        self.branches.append(branch)
        most = max(_PASSES * points, _LEAST_CYCLES)
        limits = Limits(low, high, (high - low) / points, points=most)

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
        return branch

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
        self._further_branches()
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

    def _further_branches(self) -> None:
        """Follow branches from simulated cycles that lie on none, to both sides."""
        joined, begun = len(self.branches), 0
        for found in sorted(self.simulated, key=lambda settled: settled.spread):
            if begun == _FURTHER_BRANCHES or self._is_on_branch(found):
                continue
            begun += 1
            try:
                self._from_simulation(found)
            except NumericalError as error:
                self.branches = [branch for branch in self.branches if branch.points]
                self.messages.append(
                    f"the motion simulated at {self.model.parameter} = {found.value:.6g} lies on "
                    f"no branch, and no branch can be followed from it: {error}"
                )
        if joined and len(self.branches) > joined:
            self.messages.append(
                f"branches from {joined + 1} on are followed from simulated cycles; in this range "
                "they are not found to be joined to those before"
            )

    def _from_simulation(self, found: Settled) -> None:
        """Follow the cycle that a simulation settled to, to both sides."""
        s = self.settings
        start = found.orbit(self.model, intervals=s.intervals, degree=DEGREE)
        down = self._follow(start, None, "down from the simulated one", upwards=False)
        if found.value < self.span[1] and down.points:
            first = down.points[0].orbit
            up = self._follow(first, None, "up from the simulated one")
            self.branches.remove(up)
            down.points[:0] = up.points[:0:-1]

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
        known = [d for d in differences if d is not None and d[0] < _SAME]
        if known:
            self.figures["largest_difference_amplitude"] = max(d[0] for d in known)
            self.figures["largest_difference_period"] = max(d[1] for d in known)
        wandering = [s for s in self.simulated if s.spread > 0.0]
        if wandering:
            values = ", ".join(f"{s.value:.6g}" for s in wandering)
            self.messages.append(
                f"motions simulated at {self.model.parameter} = {values} last but do not repeat: "
                f"their amplitude varies by up to {100.0 * max(s.spread for s in wandering):.2g} %"
            )
        apart = [f"{s.value:.6g}" for s in self.simulated if not self._is_on_branch(s)]
        if apart:
            self.messages.append(
                f"motions simulated at {self.model.parameter} = {', '.join(apart)} lie on no branch"
            )

    def _is_on_branch(self, found: Settled) -> bool:
        """Return whether a simulated cycle is one of a branch, or lies beside one of its points."""
        difference = self._difference(found)
        if difference is not None and difference[0] < _SAME:
            return True
        points = [point for branch in self.branches for point in branch.points]
        beside = [
            p for p in points if abs(p.orbit.parameter - found.value) < abs(_BESIDE * found.value)
        ]
        sizes = [float(self._row(0, point).amplitude[0]) for point in beside]
        return any(abs(found.amplitude / size - 1.0) < _SAME for size in sizes)

    def _difference(self, found: Settled) -> tuple[float, float] | None:
        """Return relative differences of amplitude and period to the nearest stable cycle."""
        best: tuple[float, float] | None = None
        near = [p for branch in self.branches for p in points_beside(branch, found.value)]
        for point in near:
            try:
                cycle = cycle_beside(self.model, point, found.value)
            except NumericalError:
                continue
            row = self._row(0, cycle)
            size = abs(found.amplitude / float(row.amplitude[0]) - 1.0)
            if cycle.stable and (best is None or size < best[0]):
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
