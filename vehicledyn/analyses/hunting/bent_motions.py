"""Warn of beams that bend farther in the motions of a hunting study than their modes hold for."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from vehicledyn.analyse.periodic.autonomous import AutonomousField
from vehicledyn.analyse.periodic.critical import CriticalPoint
from vehicledyn.analyse.periodic.cycle_points import Branch
from vehicledyn.analyses.preparation.prepare import AssembledPoint
from vehicledyn.analyses.preparation.prepared import Prepared
from vehicledyn.analyses.preparation.validity.bent_beams import MonitoredBeams, bent_among
from vehicledyn.base.units import shown
from vehicledyn.kernel.kernel import Kernel

_PHASES = 24
"""Instants of a cycle that are looked at."""


def bent_motions(
    prepared: Prepared,
    model: AutonomousField,
    balances: Sequence[CriticalPoint],
    branches: Sequence[Branch],
) -> list[str]:
    """Return a warning for each beam that bends far in an equilibrium or a limit cycle."""
    if not MonitoredBeams.of(prepared).names:
        return []
    return bent_among(prepared, _points(prepared, model, balances, branches))


def _points(
    prepared: Prepared,
    model: AutonomousField,
    balances: Sequence[CriticalPoint],
    branches: Sequence[Branch],
) -> Iterator[tuple[str, Kernel, AssembledPoint]]:
    unit = prepared.equations.parameters[model.index].unit

    def words(what: str, value: float) -> str:
        return f"in {what} at {model.parameter} = {shown(value, unit)}"

    def at(value: float) -> Kernel:
        return prepared.kernel.with_parameters(model.parameters(value))

    for balance in balances:
        state = model.full(balance.state[None, :])[0]
        point = AssembledPoint(state, balance.unknowns)
        yield words("the equilibrium", balance.value), at(balance.value), point
    for orbit in (point.orbit for branch in branches for point in branch.points):
        kernel = at(orbit.parameter)
        states, unknowns = orbit.sample(np.arange(_PHASES) / _PHASES)
        for state, guess in zip(model.full(states), unknowns, strict=True):
            solved = kernel.solve_unknowns(0.0, state, guess) if guess.size else guess
            yield words("the limit cycle", orbit.parameter), kernel, AssembledPoint(state, solved)
