"""Run cases of a batch by themselves, with their loops watched as lanes watch them."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.solve.cases import CaseEnd, Cases, Plan, Samples
from vehicledyn.solve.engine import WEAK_PIVOT, Vector
from vehicledyn.solve.kernel import Kernel
from vehicledyn.solve.simulate import Solver, simulate
from vehicledyn.solve.task import Statistics

Runner: TypeAlias = Callable[..., Statistics]
"""Integrates one case, called as :func:`vehicledyn.solve.simulate.simulate`."""


class _Weak(Exception):  # noqa: N818
    """A loop comes near to a singular configuration."""


@dataclass
class Alone:
    """Runs cases by themselves, whether or not they were in lanes before."""

    kernel: Kernel
    solver: Solver
    plan: Plan
    runner: Runner

    @property
    def has_loops(self) -> bool:
        """Whether the model has loops whose dependent coordinates may have to change."""
        return bool(self.kernel.equations.structure.get("loops"))

    def run(self, case: Cases, room: Samples) -> CaseEnd:
        """Run a case; where its loops fail or become weak, again with the runner.

        The first try is that of a lane, so that a case is the same with and without lanes.
        """
        if self.runner is simulate or not self.has_loops:
            return self._run(self.runner, case, room, watched=False)
        if hasattr(self.solver, "fixed_method"):
            with contextlib.suppress(_Weak):
                end = self._run(simulate, case, room, watched=True)
                if not end.failed:
                    return end
            room[:] = np.nan
        return self._run(self.runner, case, room, watched=False)

    def _run(self, runner: Runner, case: Cases, room: Samples, *, watched: bool) -> CaseEnd:
        plan, kernel = self.plan, self.kernel.with_parameters(case.parameters[0])
        last, count = plan.start, 0
        watch = _PivotWatch(kernel) if watched else None

        def keep(times: Vector, states: Vector, unknowns: Vector, outputs: Vector) -> None:
            nonlocal last, count
            if watch is not None:
                watch.look(times, states, unknowns)
            room[count : count + len(times)] = outputs[: len(room) - count, plan.channels]
            last, count = float(times[-1]), count + len(times)

        try:
            done = runner(
                kernel,
                self.solver,
                start=plan.start,
                stop=float(plan.times[-1]),
                state=case.states[0],
                unknowns=case.unknowns[0],
                interval=plan.interval,
                sink=keep,
            )
        except NumericalError as error:
            return CaseEnd(last, count, str(error))
        return CaseEnd(last, count, ended_by=done.ended_by or "")


class _PivotWatch:
    """Looks at the determinants of the blocks at the samples, as lanes do."""

    def __init__(self, kernel: Kernel) -> None:
        self._kernel = kernel
        self._before: Vector | None = None
        self._largest = np.zeros(len(kernel.equations.blocks))

    def look(self, times: Vector, states: Vector, unknowns: Vector) -> None:
        """Raise _Weak where a determinant has become weak or changed its sign."""
        for values in self._kernel.pivots(times, states, unknowns):
            sizes = np.abs(values)
            self._largest = np.maximum(self._largest, sizes)
            before = values if self._before is None else self._before
            if not ((sizes >= WEAK_PIVOT * self._largest) & (values * before > 0.0)).all():
                raise _Weak
            self._before = values
