"""A hunting study while it is made: equilibria, branches of cycles, and the check of these."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.branch import follow_cycles
from vehicledyn.analyse.periodic.collocation import Direction
from vehicledyn.analyse.periodic.critical import CriticalPoint, Divergence, Hopf
from vehicledyn.analyse.periodic.cycle_points import Branch, CyclePoint, Limits
from vehicledyn.analyse.periodic.orbit import Orbit
from vehicledyn.analyse.periodic.outside_range import outer_range
from vehicledyn.analyse.settling.simulated_cycles import Runner, Settled, leading
from vehicledyn.analyses.hunting.branch_matching import Legs
from vehicledyn.analyses.hunting.branches_from_simulation import FromSimulations
from vehicledyn.analyses.hunting.budget import FEWEST_CYCLES, Budget, budget_of
from vehicledyn.analyses.hunting.critical_values import far_from, lowest_stable, of_equilibria
from vehicledyn.analyses.hunting.cycle_rows import CycleRows
from vehicledyn.analyses.hunting.equilibria import Equilibria
from vehicledyn.analyses.hunting.lower_range import growing_shape, lower_range
from vehicledyn.analyses.hunting.parameter_starts import ParameterStarts
from vehicledyn.analyses.hunting.saving import Saving
from vehicledyn.analyses.hunting.simulation_check import Check
from vehicledyn.analyses.hunting.start import (
    DEGREE,
    HuntSettings,
    first_balance,
    moving_channels,
    parameter_index,
    span_of,
    watched_channels,
)
from vehicledyn.analyses.hunting.symmetry_broken_branches import Secondary
from vehicledyn.analyses.hunting.upper_range import upper_range
from vehicledyn.analyses.preparation.prepared import Prepared, Progress
from vehicledyn.analyses.preparation.sources import laws_that_bend
from vehicledyn.base.argument_names import argument
from vehicledyn.base.errors import NumericalError
from vehicledyn.base.units import shown
from vehicledyn.files.scenario.target import Target
from vehicledyn.results.store.linear_file import Quantity
from vehicledyn.results.tables.hunt_table import HuntTable, SimulatedRow

Vector = NDArray[np.float64]

_VALUES, _FEWEST_VALUES = 60, 20
"""Values at which the equilibrium is looked for where no points are asked for, and at least."""

_NO_LAW = "look for play, dry friction or another law that bends at rest"

_MET = 2
"""Cycles in a row on another branch with which a branch has reached it."""


class _JoinedError(Exception):
    """A branch reaches another one, of this number."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self.number = number


@dataclass
class Study:
    """A study while it is made; what was found is kept whatever comes."""

    prepared: Prepared
    settings: HuntSettings
    model: AutonomousField
    title: str
    watched: list[int]
    progress: Progress
    span: tuple[float, float]
    start: tuple[Vector, Vector]
    equilibria: Equilibria
    hopfs: list[Hopf] = field(default_factory=list)
    divergences: list[Divergence] = field(default_factory=list)
    branches: list[Branch] = field(default_factory=list)
    origins: dict[int, str] = field(default_factory=dict)
    figures: dict[str, float] = field(default_factory=dict)
    means: dict[str, str] = field(default_factory=dict)
    messages: list[str] = field(default_factory=list)
    status: str = "ok"

    @staticmethod
    def of(prepared: Prepared, target: Target, settings: HuntSettings, progress: Progress) -> Study:
        """Return a study at its beginning: the equilibrium near the first value."""
        parameters = prepared.equations.parameters
        names = [p.name for p in parameters]
        index = parameter_index(names, settings.parameter, prepared.equations.name)
        span = span_of(parameters[index].unit, settings)
        progress("finding the equilibrium", None)
        model, start = first_balance(prepared, index, span[0], target)
        starts = ParameterStarts(prepared, target, settings.parameter)
        return Study(
            prepared,
            settings,
            model,
            target.title,
            watched_channels(prepared, settings.channels, model),
            progress,
            span,
            start,
            Equilibria(model, starts, span),
        )

    @property
    def balances(self) -> list[CriticalPoint]:
        """The equilibria."""
        return self.equilibria.balances

    @property
    def _unit(self) -> str:
        """The parameter's unit."""
        return self.prepared.equations.parameters[self.model.index].unit

    def write_to(self, saving: Saving) -> None:
        """Write what is found while it is."""
        report = self.progress

        def progress(what: str, part: float | None) -> None:
            saving.maybe(self.table)
            report(what, part)

        self.progress = progress

    def examine(self) -> None:
        """Follow equilibria and cycles, and check them by simulation."""
        try:
            self.follow_equilibria()
            if self.equilibria.neutral:
                self._report_neutral()
            else:
                self._cycles()
                self._simulations()
        except KeyboardInterrupt:
            words = f"stopped by the user; partial results are kept, {argument('resume')} continues"
            self._ended("interrupted", words)
        except NumericalError as error:
            if not self.balances:
                raise NumericalError(
                    f"{error}; a motion whose speed slowly falls is not steady either"
                ) from None
            self._ended("failed", f"{error}; what was found is kept")
        check = vars(self).get("_check")
        if check is not None:
            check.conclude()
            self.messages += check.messages

    def table(self) -> HuntTable:
        """Return everything that was found."""
        e = self.prepared.equations
        self._figures()
        entry = e.parameters[self.model.index]
        eigenvalues = [b.eigenvalues for b in self.balances]
        check = vars(self).get("_check")
        rows = [
            self._rows.row(number, point)
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
            tuple(
                SimulatedRow(f.value, f.amplitude, f.period, f.spread, f.seconds, str(f.ending))
                for f in (check.found if check is not None else ())
            ),
            self.figures,
            self.status,
            "; ".join(self.messages),
            self.origins,
            self.means,
        )

    def follow_equilibria(self) -> None:
        """Follow the equilibria, also to where oscillations begin beside the range."""
        count = max(self.settings.points or _VALUES, _FEWEST_VALUES)
        values = [float(value) for value in np.linspace(*self.span, count)]
        why = self.equilibria.follow(values, self.start, self.progress)
        if why:
            self._ended("partial", f"{why}; the equilibrium is followed up to there")
        self.hopfs = self.equilibria.hopfs
        grows = bool(self.balances[0].growing_pairs)
        if not self.hopfs and not self.equilibria.neutral and (grows or not why):
            self._widen(grows=grows)
        self.divergences = self.equilibria.divergences

    def _widen(self, *, grows: bool) -> None:
        """Begin below the range, where an oscillation begins that grows in it, or end above it."""
        further = lower_range if grows else upper_range
        beside = further(self.equilibria, self.span, self._unit)
        if beside.words:
            self.messages.append(beside.words)
        if beside.balances:
            self.balances.extend(beside.balances)
            self.balances.sort(key=lambda balance: balance.value)
            low, high = self.balances[0].value, self.balances[-1].value
            self.span = min(self.span[0], low), max(self.span[1], high)
            self.hopfs = self.equilibria.hopfs
        elif grows and not self.settings.channels:
            shape = growing_shape(self.model, self.balances[0])
            self.watched = moving_channels(self.prepared, self.model, shape) or self.watched

    def _report_neutral(self) -> None:
        """Say why no cycles are looked for."""
        names = ", ".join(self.equilibria.neutral)
        self.messages.append(
            "limit cycles are neither followed nor simulated: steady motions are not isolated, "
            f"nothing drives or holds {names}, so that cycles are not either; hold it to find them"
        )

    def _cycles(self) -> None:
        s = self.settings
        if self.hopfs and not s.channels:
            moving = moving_channels(self.prepared, self.model, self.hopfs[0].shape)
            self.watched = moving or self.watched
        for hopf in self.hopfs:
            if any(self._reaches(branch, hopf) for branch in self.branches):
                continue
            index = leading(self.model, hopf.shape)
            start = hopf.orbit(s.amplitude, index, intervals=s.intervals, degree=DEGREE)
            place = f"from {hopf.balance.value:.6g}"
            try:
                branch = self._follow(start, hopf.growing(start), place)
            except NumericalError as error:
                self.branches[:] = [branch for branch in self.branches if branch.points]
                self._ended("partial", f"no branch of cycles is found {place} on: {error}")
                continue
            number = len(self.branches)
            remark = far_from(hopf, branch, number, amplitude=s.amplitude, span=self.span)
            if remark:
                laws = laws_that_bend(self.equilibria.starts.target) or [_NO_LAW]
                self.messages.append("; ".join([remark, *laws]))
        if s.secondary or (s.secondary is None and self._legs.lack_stable(self.balances)):
            self._secondary()

    def _follow(
        self,
        start: Orbit,
        direction: Direction | None,
        place: str,
        *,
        upwards: bool = True,
        most: int | None = None,
        wide: float = 1.0,
        known: Sequence[Branch] = (),
        joins: Callable[[Branch], int | None] | None = None,
    ) -> Branch:
        """Follow a branch of at most so many cycles; ``wide`` makes its steps wider.

        It ends where two cycles in a row lie on a branch that is ``known``, and where it ``joins``
        one, and returns its number.
        """
        low, high = self.span
        budget, branch = self._budget, Branch()
        self.branches.append(branch)
        most = most or self._left()
        step, outer = wide * (high - low) / budget.points, outer_range(low, high)
        limits = Limits(low, high, step, points=most, outer=outer)

        def report(point: CyclePoint) -> None:
            where = shown(point.orbit.parameter, self._unit)
            what = f"following the limit cycles {place}, at {where}, of {most} cycles at most"
            self.progress(what, len(branch.points) / most)
            met = [self._legs.meets(p, known) for p in branch.points[-_MET:]] if known else []
            if len(met) == _MET and met[0] is not None and met[0] == met[1]:
                raise _JoinedError(met[0] + 1)
            number = joins(branch) if joins is not None else None
            if number is not None:
                raise _JoinedError(number)

        name = f"branch {len(self.branches)}"
        try:
            follow_cycles(
                self.model,
                start,
                direction,
                limits,
                branch=branch,
                report=report,
                upwards=upwards,
            )
        except _JoinedError as joined:
            del branch.points[1 - _MET :]
            branch.ending = "joined"
            place = f"{self.model.parameter} = {branch.points[-1].orbit.parameter:.6g}"
            self.messages.append(f"{name} joins branch {joined.number} near {place}")
        self.messages.extend(f"{name}: {remark}" for remark in branch.remarks)
        if branch.ending == "lost":
            self._ended("partial", f"{name}: {branch.reason}")
        if branch.ending == "points":
            self.messages.append(
                f"{name}: {branch.reason}; it continues: raise {argument('points')}, "
                f"{budget.points} here (a "
                f"cycle is expected to take {budget.each:.1g} s)"
            )
        return branch

    def _secondary(self) -> None:
        """Follow the branches of cycles that are no longer mirror-symmetric."""
        args = self.model, self.span, self.branches, self.messages, self.origins
        Secondary(*args, self._follow).examine(self._budget.further)

    def _left(self) -> int:
        """Return how many cycles the next branch may have; each as many where points are asked."""
        cycles = self._budget.cycles
        used = sum(len(branch.points) for branch in self.branches)
        return max(cycles - used, FEWEST_CYCLES) if self.settings.points is None else cycles

    def _reaches(self, branch: Branch, hopf: Hopf) -> bool:
        """Return whether a branch ended at a Hopf bifurcation."""
        if branch.ending != "equilibrium" or not branch.points:
            return False
        end = branch.points[-1].orbit.parameter
        return abs(end - hopf.balance.value) < 1e-2 * (self.span[1] - self.span[0])

    def _simulations(self) -> None:
        s = self.settings
        check = self._check if s.simulate else None
        if check is None:
            return
        stages: list[Callable[[], None]] = [
            partial(check.lower, s.disturbance, self.branches),
            check.compare,
            partial(self._further_branches, check.found),
            check.keep,
            check.compare,
            partial(check.raise_, s.amplitude, self.hopfs),
        ]
        for stage in stages:
            try:
                stage()
            except NumericalError as error:
                self._ended("partial", f"the check by simulation is not complete: {error}")

    @cached_property
    def _check(self) -> Check | None:
        """The check by simulation; None where nothing oscillates."""
        if not any(np.any(b.eigenvalues.imag != 0.0) for b in self.balances):
            return None
        kernel = self.prepared.kernel
        runner = Runner(kernel, self.model, self.watched[0])
        allowed, levels = self._budget.seconds, self.settings.levels
        return Check(runner, self.balances, self._legs, levels, allowed, self.progress)

    @cached_property
    def _budget(self) -> Budget:
        return budget_of(self.settings, self.prepared.kernel, self.balances, self.hopfs)

    @cached_property
    def _rows(self) -> CycleRows:
        return CycleRows(self.prepared.kernel, self.model, self.watched)

    @cached_property
    def _legs(self) -> Legs:
        return Legs(self.model, self._rows, self.branches)

    def _further_branches(self, simulated: Sequence[Settled]) -> None:
        """Follow the cycles that simulations settled to and that lie on no branch."""
        FromSimulations(
            self.model,
            self.span[1],
            self.settings.intervals,
            self.branches,
            self.messages,
            self._legs,
            self._follow,
        ).examine(simulated, self._budget.further)

    def _figures(self) -> None:
        """Note the critical values, and how far simulation and continuation differ."""
        self.figures |= of_equilibria(self.hopfs, self.divergences)
        lowest = lowest_stable(self.branches, self.span)
        if lowest is not None:
            self.figures["nonlinear_critical"], self.means["nonlinear_critical"] = lowest
        check = vars(self).get("_check")
        if check is not None:
            self.figures |= check.figures
            self.means |= check.means

    def _ended(self, status: str, message: str) -> None:
        self.status = status
        self.messages.append(message)
