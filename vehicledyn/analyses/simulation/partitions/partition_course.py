"""Where a run with fixed steps changes its dependent coordinates, for analyses that follow it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.simulation.partitions.partitioned_run import PartitionedRun
from vehicledyn.analyses.simulation.partitions.repartitioning import may_change, steps_per_look
from vehicledyn.analyses.simulation.run_plan import RunPlan
from vehicledyn.analyses.simulation.sample_delivery import Delivery
from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.fixed_step import FixedSteps
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.tangent_code import StepRow
from vehicledyn.multibody.model.system import System

if TYPE_CHECKING:
    from vehicledyn.multibody.loops.partition_monitor import PartitionMonitor

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class RunCourse:
    """Samples of a run and its partitions.

    ``times`` (n_times,) [s]; ``states`` (n_times, n_states) and ``channels`` (n_times, n_channels)
    are those of the first equations, not a number where a later partition lacks one. ``changes``
    are the times at which other kernels take over.
    """

    times: Floats
    states: Floats
    channels: Floats
    changes: tuple[tuple[float, Kernel], ...]
    ended_by: str


@dataclass
class PartitionCourse:
    """Runs of a system with dependent coordinates; kernels of other partitions are kept."""

    system: System
    make_watch: Callable[[], PartitionMonitor]
    known: dict[tuple[str, ...], Kernel] = field(default_factory=dict)

    @staticmethod
    def needed(kernel: Kernel) -> bool:
        """Return whether runs of a kernel may need other dependent coordinates on the way."""
        return may_change(kernel.equations)

    def run(
        self, kernel: Kernel, grid: StepRow, n_intervals: int, start: tuple[Floats, Floats]
    ) -> RunCourse:
        """Return a run with fixed steps, as a simulation takes them.

        Raises
        ------
        NumericalError
            If it cannot go on, passes a singular configuration by steps of another kind, or
            treats its constraints with multipliers on the way.
        """
        parts: list[tuple[Floats, Floats, Floats]] = []
        changes: list[tuple[float, Kernel]] = []
        left: list[float] = []

        def happened(name: str, time: float) -> None:
            if name == "partition.changed":
                changes.append((time, run.kernel_in_use))
            elif name == "constraint_method.changed":
                left.append(time)

        def take(times: Floats, states: Floats, _: Floats, outputs: Floats) -> None:
            parts.append((times.copy(), states.copy(), outputs.copy()))

        equations = kernel.equations
        plan = RunPlan(
            FixedSteps(grid.method, grid.interval / grid.per_interval),
            grid.start,
            grid.start + grid.interval * n_intervals,
            grid.interval,
            1,
            Delivery(equations, take).take,
            lambda *_: None,
            happened,
        ).looked_at(steps=steps_per_look(equations))
        run = PartitionedRun(self.system, kernel, equations, plan, self.make_watch, self.known)
        statistics = run.go(*(np.array(item) for item in start))
        if left:
            raise NumericalError(
                f"no partition of the coordinates lasts at t = {left[0]:.9g} s, and derivatives do "
                "not follow constraints with multipliers; end the run before"
            )
        if run.has_passed:
            raise NumericalError(
                "the run passes a singular configuration by steps that derivatives do not follow; "
                "end it before"
            )
        times, states, channels = (np.concatenate(item) for item in zip(*parts, strict=True))
        return RunCourse(times, states, channels, tuple(changes), statistics.ended_by or "")
