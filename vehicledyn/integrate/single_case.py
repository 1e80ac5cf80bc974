"""Run cases of a batch by themselves, with their partition watched as lanes watch it."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.cases import CaseEnd, Cases, Samples, SamplingPlan
from vehicledyn.integrate.judged_quantities import Judged
from vehicledyn.integrate.simulate import Solver, simulate
from vehicledyn.integrate.task import Statistics
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.rate_monitor import RateMonitor, Soundness

Runner: TypeAlias = Callable[..., Statistics]
"""Integrates one case, called as :func:`vehicledyn.integrate.simulate.simulate`."""


Judging: TypeAlias = Callable[[int], Judged]
"""Gives what the accuracy of a case is judged by, from its number."""


class _Weak(Exception):  # noqa: N818
    """The partition comes near to a singular configuration."""


@dataclass
class SingleCase:
    """Runs cases by themselves, whether or not they were in lanes before."""

    kernel: Kernel
    solver: Solver
    plan: SamplingPlan
    runner: Runner
    rates: RateMonitor | None
    judged: Judging

    @property
    def is_watched(self) -> bool:
        """Whether a case may have to be run again, with other dependent coordinates."""
        return self.has_loops or self.rates is not None

    @property
    def has_loops(self) -> bool:
        """Whether the model has loops whose dependent coordinates may have to change."""
        return bool(self.kernel.equations.structure.get("loops"))

    def run(self, cases: Cases, number: int, room: Samples) -> CaseEnd:
        """Run a case, by number; where its partition fails or is weak, again with the runner.

        The first try is that of a lane, so that a case is the same with and without lanes.
        """
        case, judged = cases.part(slice(number, number + 1)), self.judged(number)
        if self.runner is simulate or not self.is_watched:
            return self._run(self.runner, case, room, judged, watched=False)
        if hasattr(self.solver, "fixed_method"):
            with contextlib.suppress(_Weak):
                end = self._run(simulate, case, room, judged, watched=True)
                if not end.failed:
                    return end
            room[:] = np.nan
        return self._run(self.runner, case, room, judged, watched=False)

    def _of_rates(self, times: Vector, outputs: Vector) -> Vector:
        """Return the determinants of rates by all channels at some times, one column or none."""
        if self.rates is None:
            return np.zeros((len(times), 0))
        return self.rates.determinants(times, outputs[:, self.rates.channels])[:, None]

    def _run(
        self, runner: Runner, case: Cases, room: Samples, judged: Judged, *, watched: bool
    ) -> CaseEnd:
        plan, kernel = self.plan, self.kernel.with_parameters(case.parameters[0])
        last, count = plan.start, 0
        soundness = Soundness() if watched else None

        def keep(times: Vector, states: Vector, unknowns: Vector, outputs: Vector) -> None:
            nonlocal last, count
            if soundness is not None:
                pivots = kernel.pivots(times, states, unknowns)
                if not soundness.holds(np.column_stack([pivots, self._of_rates(times, outputs)])):
                    raise _Weak
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
                judged=judged,
            )
        except NumericalError as error:
            return CaseEnd(last, count, str(error))
        return CaseEnd(last, count, ended_by=done.ended_by or "", accuracy=done.accuracy)
