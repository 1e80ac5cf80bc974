"""The equilibria of a hunting study along its parameter, and where they lose stability."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.critical import (
    CriticalPoint,
    Divergence,
    Hopf,
    ahead,
    find_balance,
    find_divergence,
    find_hopf,
    neutral_directions,
)
from vehicledyn.analyses.hunting.parameter_starts import ParameterStarts
from vehicledyn.analyses.hunting.start import balanced_point
from vehicledyn.analyses.preparation.prepared import Prepared, Progress
from vehicledyn.base.argument_names import given
from vehicledyn.base.errors import InputError, NumericalError
from vehicledyn.base.units import shown
from vehicledyn.kernel.engine import Vector

_AGREE, _STANDS = 1e-6, 1e-3
"""Relative difference of a rate from its start with which the motion is that of the start, and
part of it below which a motion stands still."""


@dataclass
class Equilibria:
    """Equilibria while they are followed.

    Where an equilibrium may move on without force, as a vehicle at any speed, that of the start
    values is taken, which are found again at each value of the parameter.

    Parameters
    ----------
    model
        The equations.
    starts
        The starts of the file along the parameter.
    span
        The range of the parameter.
    """

    model: AutonomousField
    starts: ParameterStarts
    span: tuple[float, float]
    balances: list[CriticalPoint] = field(default_factory=list)
    _known: dict[float, Prepared] = field(default_factory=dict)

    def follow(
        self, values: Sequence[float], start: tuple[Vector, Vector], report: Progress
    ) -> str:
        """Find the equilibria at all values; return why it ends before the last, if it does.

        Raises
        ------
        InputError
            If the parameter changes nothing that lasts.
        NumericalError
            If there is none at the first value, or the motion that the start asks for is not
            steady.
        """
        state, unknowns = start
        for k, value in enumerate(values):
            report("following the equilibrium", k / len(values))
            if self.balances:
                before = self.balances[-1]
                state, unknowns = self.model.memory.recall(
                    "ahead", (before, value), partial(ahead, self.model, before, value)
                )
            try:
                found = self.at(float(value), state, unknowns)
            except NumericalError as error:
                if not self.balances:
                    raise
                return str(error)
            self.balances.append(found)
            if k == 0:
                self._refuse_idle_parameter()
            self._refuse_other_motion(found)
        return ""

    def at(self, value: float, state: Vector, unknowns: Vector) -> CriticalPoint:
        """Return the equilibrium at a value, near states and unknowns or that of the start."""
        if self.balances and self._starts_count:
            state, unknowns = self._start_at(value)
        return self.model.memory.recall_or_raise(
            "balance",
            (value, state, unknowns),
            partial(find_balance, self.model, value, state, unknowns),
        )

    @property
    def hopfs(self) -> list[Hopf]:
        """Where oscillations begin or cease to grow."""
        return find_hopf(self.model, self.balances, self.at)

    @property
    def divergences(self) -> list[Divergence]:
        """Where motions begin or cease to grow without oscillation."""
        return find_divergence(self.model, self.balances, self.at)

    @cached_property
    def neutral(self) -> list[str]:
        """Names of states that an equilibrium may change without force, empty if it is isolated."""
        directions = np.abs(neutral_directions(self.model, self.balances[0]))
        return [self.model.names[int(k)] for k in dict.fromkeys(directions.argmax(axis=0).tolist())]

    @cached_property
    def _starts_differ(self) -> bool:
        return self.starts.differ(*self.span)

    @cached_property
    def _starts_count(self) -> bool:
        """Whether the start decides which of many equilibria is taken at a value."""
        return bool(self.neutral) and self._starts_differ

    def _prepared_at(self, value: float) -> Prepared:
        if value not in self._known:
            prepared = self.starts.at(value)
            prepared.kernel.set_parameters(self.model.parameters(value))
            self._known = {value: prepared}
        return self._known[value]

    def _start_at(self, value: float) -> tuple[Vector, Vector]:
        def found() -> tuple[Vector, Vector]:
            prepared, scenario = self._prepared_at(value), self.starts.target.choices
            point = balanced_point(prepared, self.starts.name, value, scenario, self.model)
            return self.model.reduced(point.state), point.unknowns

        return self.model.memory.recall_or_raise("start", value, found)

    def _refuse_idle_parameter(self) -> None:
        """Refuse a parameter that changes neither the equations nor which motion is steady."""
        if self.model.depends_on_parameter or self._starts_count:
            return
        name = self.starts.name
        if not self._starts_differ:
            raise InputError(
                f"{given('parameter', name)}: neither the equations nor the start depend on "
                "it; vary "
                "another parameter"
            )
        raise InputError(
            f"{given('parameter', name)}: it changes the start alone, and the steady motion "
            "found near the "
            "start is the same at every value; vary another parameter, or start from the steady "
            "motion itself, without disturbances in 'initial'"
        )

    def _refuse_other_motion(self, found: CriticalPoint) -> None:
        """Refuse an equilibrium that has not the rates of running on that its start asks for."""
        value = found.value
        prepared = self._prepared_at(value) if self._starts_count else self.starts.prepared
        e, given = prepared.equations, prepared.subject.given_rates
        kept = {e.states[k].name for k in self.model.kept} | {u.name for u in e.unknowns}
        place = {channel.name: k for k, channel in enumerate(e.channels)}
        running = {n: r for n, r in given.items() if n not in kept and f"{n}_rate" in place}
        if not running:
            return
        kernel = prepared.kernel.with_parameters(self.model.parameters(value))
        outputs = kernel.outputs(0.0, self.model.full(found.state), found.unknowns)
        for name, rate in running.items():
            own = float(outputs[place[f"{name}_rate"]])
            stands = abs(own) < _STANDS * abs(rate)
            if stands or (self._starts_count and abs(own - rate) > _AGREE * abs(rate)):
                unit = e.channels[place[f"{name}_rate"]].unit
                raise NumericalError(
                    f"{self.starts.name} = {value:.6g}: the motion of the start is not steady: "
                    f"{name}_rate is to be {shown(rate, unit)}, the equilibrium has "
                    f"{shown(own, unit)}; hold that rate by a drive, or start from a steady motion"
                )
