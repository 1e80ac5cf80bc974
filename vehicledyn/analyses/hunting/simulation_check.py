"""The check of a hunting study by simulation: lowered, kept and raised."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from vehicledyn.analyse.periodic.critical import CriticalPoint, Hopf
from vehicledyn.analyse.periodic.cycle_points import Branch
from vehicledyn.analyse.settling.parameter_rampdown import (
    balances_near,
    growth_begins,
    lower,
    steps,
)
from vehicledyn.analyse.settling.settling import Ending
from vehicledyn.analyse.settling.simulated_cycles import Runner, Settled
from vehicledyn.analyses.hunting.branch_matching import Legs
from vehicledyn.analyses.preparation.prepared import Progress
from vehicledyn.base.argument_names import argument
from vehicledyn.base.units import shown

_RESOLUTION = 2e-4
"""Part of the range to which values found by simulation are known."""

_LOWERING = 0.8
"""Part of the motion that may be simulated while the parameter is lowered."""

_MOVED = 0.03
"""Part of the way to the equilibrium by which cycles are disturbed that should stay."""


@dataclass
class Check:
    """A check while it is made: ``found`` are motions that last, ``messages`` for the user."""

    runner: Runner
    balances: Sequence[CriticalPoint]
    legs: Legs
    levels: int
    allowed: float
    progress: Progress
    found: list[Settled] = field(default_factory=list)
    differences: list[tuple[float, float]] = field(default_factory=list)
    messages: list[str] = field(default_factory=list)
    figures: dict[str, float] = field(default_factory=dict)
    means: dict[str, str] = field(default_factory=dict)

    @property
    def _span(self) -> tuple[float, float]:
        return self.balances[0].value, self.balances[-1].value

    @property
    def _resolution(self) -> float:
        return _RESOLUTION * (self._span[1] - self._span[0])

    @property
    def _falling(self) -> list[float]:
        low, high = self._span
        return list(steps(high, low, self.levels))

    def lower(self, disturbance: float, branches: Sequence[Branch]) -> None:
        """Lower the parameter from the end of the range, until the cycle dies."""
        values = self._falling
        self._report("lowering", values)
        self.runner.allowed = _LOWERING * self.allowed
        ends = [
            p.orbit.parameter for b in branches for p in b.special if p.kind in ("fold", "torus")
        ]
        lowered = lower(
            self.runner,
            values,
            balances_near(self.runner.field, self.balances),
            disturbance,
            resolution=self._resolution,
            expected=ends,
            report=self.found.append,
        )
        if lowered.between is not None:
            self.figures["simulated_lowering"] = lowered.between[0]
            begin = self._value(values[0])
            self.means["simulated_lowering"] = f"from what {disturbance:g} grows to at {begin}"
        if lowered.reason:
            place = f" at {self._value(self.found[-1].value)}" if self.found else ""
            self.messages.append(
                f"the check by lowering {self._name} in simulations ends{place}: {lowered.reason}; "
                f"{argument('simulated')} allows more"
            )

    def keep(self) -> None:
        """Simulate stable cycles of the branches to which lowering has not come.

        Each is disturbed and must return to itself.
        """
        values = self._falling
        self._report("simulating stable cycles along", values)
        self.runner.allowed = self.allowed
        balances, left = balances_near(self.runner.field, self.balances), []
        for value in values:
            for leg in self.legs.at(value):
                known = any(f.value == value and leg.holds(f) for f in self.found)
                if known or not leg.stable:
                    continue
                if self.runner.is_spent:
                    left.append(value)
                    continue
                cycle = self.legs.exact(leg, value)
                if cycle is not None and cycle.stable:
                    start = self.runner.beside(cycle.orbit, balances(value), _MOVED)
                    self._kept(self.runner.settle(value, start))
        if left:
            listed = ", ".join(f"{v:.6g}" for v in dict.fromkeys(left))
            self.messages.append(
                f"stable cycles at {self._name} = {listed} are not simulated: "
                f"{self.runner.spent:.3g} s of motion are, as many as are allowed; "
                f"{argument('simulated')} "
                "allows more"
            )

    def compare(self) -> None:
        """Note by how much the cycles at the levels differ from those of the branches."""
        levels = self._falling
        self.differences.clear()
        for number, found in enumerate(self.found):
            self.progress("comparing the simulated cycles", number / len(self.found))
            difference = self.legs.difference(found) if found.value in levels else None
            if difference is not None:
                self.differences.append(difference)

    def raise_(self, amplitude: float, hopfs: Sequence[Hopf]) -> None:
        """Raise the parameter from the begin of the range, until a small disturbance grows."""
        values = list(steps(*self._span, self.levels))
        self._report("raising", values)
        grown = growth_begins(
            self.runner,
            values,
            balances_near(self.runner.field, self.balances),
            amplitude,
            resolution=self._resolution,
            expected=[h.balance.value for h in hopfs if h.begins],
        )
        if grown is not None:
            self.figures["simulated_raising"] = grown[1]

    def conclude(self) -> None:
        """Note how far simulation and continuation differ, and what has not settled."""
        if not self.runner.runs:
            return
        self.figures["simulated_seconds"] = self.runner.spent
        if self.differences:
            self.figures["largest_difference_amplitude"] = max(d[0] for d in self.differences)
            self.figures["largest_difference_period"] = max(d[1] for d in self.differences)
        self._report_ending(Ending.WANDERS, "last but do not repeat")
        self._report_ending(Ending.SLOW, "settle too slowly to wait for")
        self._report_ending(Ending.CUT, "are cut short")
        settled = (s for s in self.found if s.ending is Ending.SETTLED)
        apart = [f"{s.value:.6g}" for s in settled if not self.legs.is_known(s)]
        if apart:
            self.messages.append(
                f"motions simulated at {self._name} = {', '.join(apart)} lie on no branch"
            )

    @property
    def _name(self) -> str:
        return self.runner.field.parameter

    def _value(self, value: float) -> str:
        unit = self.runner.field.equations.parameters[self.runner.field.index].unit
        return shown(value, unit)

    def _kept(self, settled: Settled) -> None:
        if settled.alive:
            self.found.append(settled)
            return
        self.messages.append(
            f"the stable cycle at {self._name} = {settled.value:.6g} is left in a simulation: from "
            f"a disturbance of {100.0 * _MOVED:.2g} % the motion {settled.ending}"
        )

    def _report(self, what: str, values: Sequence[float]) -> None:
        """Report at which value each simulation is, and how much is done."""
        first, last = values[0], values[-1]

        def begins(value: float) -> None:
            way = abs((value - first) / (last - first))
            spent, allowed = self.runner.spent, self.runner.allowed
            place = f"{what} {self._name} in simulations, at {self._value(value)}"
            self.progress(
                f"{place}, {spent:.3g} of at most {allowed:.3g} s simulated",
                min(1.0, max(way, spent / allowed)),
            )

        self.runner.begins = begins

    def _report_ending(self, ending: Ending, words: str) -> None:
        such = [s for s in self.found if s.ending is ending]
        if not such:
            return
        values = ", ".join(f"{s.value:.6g}" for s in such)
        self.messages.append(
            f"motions simulated at {self._name} = {values} {words}: their amplitude varies by up "
            f"to {100.0 * max(s.spread for s in such):.2g} %"
        )
