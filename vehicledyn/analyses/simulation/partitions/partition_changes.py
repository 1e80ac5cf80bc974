"""Choose the dependent coordinates of a running system anew, where others do clearly better."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.simulation.partitions.rederived import (
    Origin,
    derived_from,
    state_in,
    values_of,
)
from vehicledyn.analyses.simulation.partitions.singularity_crossing import Sample
from vehicledyn.analyses.simulation.partitions.singularity_monitor import (
    FINE_LEVERAGE,
    LEVERAGE,
    PivotLog,
)
from vehicledyn.analyses.simulation.run_plan import PieceStart, RunPlan
from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.task import Statistics
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.make_kernel import compile_kernel
from vehicledyn.multibody.model.system import MOST_ENTANGLED, System
from vehicledyn.symbolic.equations import Equations

if TYPE_CHECKING:
    from vehicledyn.multibody.loops.partition_monitor import PartitionComparison, PartitionMonitor

Vector = NDArray[np.float64]

_GAIN = 0.5
"""A new partition must bring the leverage down to this part."""
_INACCURATE = 10.0 * FINE_LEVERAGE
"""Leverage behind which steps of a fixed size are inaccurate, if other coordinates do better."""
_WELL_REGULAR = 0.02
"""Least singular value of scaled constraints that is far from a singular position [1]."""
_PROBE = 1e-7
"""Time over which rates of pivots are found [s]."""
_COMPILED = 3
"""Partitions that are compiled whatever follows: that of the start, and the next two."""
_MANY_CHANGES = 6
"""Changes of partitions that do not last, behind which constraints are left to multipliers."""
_BRIEF = 2_000
"""Steps that partitions must last on average for the compiler to pay.

A step of a net of six points takes 0.6 ms by the virtual machine and 0.03 ms compiled; to print
and compile its equations takes 1.2 s.
"""
_log = logging.getLogger(__name__)


class RestartPoint(NamedTuple):
    """Where a run goes on: number of the look, states and unknowns."""

    look: int
    state: Vector
    unknowns: Vector


@dataclass
class PartitionChanges:
    """Compares partitions along a run and changes its kernel.

    ``first`` are the equations that the run began with, ``known`` the kernels of other partitions
    derived so far, ``parts`` what the steps taken once more are counted in, ``event_times`` when
    events have happened [s]. ``origins`` says where the equations of this run come from,
    ``choices`` the rows that its watch begins with, ``count`` how often the partition has changed.
    """

    system: System
    kernel: Kernel
    first: Equations
    plan: RunPlan
    make_watch: Callable[[], PartitionMonitor]
    known: dict[tuple[str, ...], Kernel]
    parts: list[Statistics]
    changed_at: float = -np.inf
    event_times: list[float] = field(default_factory=list)
    log: PivotLog = field(init=False)
    origins: dict[tuple[str, ...], Origin] = field(default_factory=dict, init=False)
    choices: dict[tuple[int, ...], list[int]] = field(default_factory=dict, init=False)
    count: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        """Remember whether the run compiles its kernels."""
        self.compiles = self.kernel.backend == "compiled"

    @cached_property
    def watch(self) -> PartitionMonitor:
        """What compares the partitions of the system."""
        watch = self.make_watch()
        if self.choices:
            watch.choices = self.choices
        return watch

    @cached_property
    def leverage(self) -> float:
        """Leverage that a partition is kept with."""
        return LEVERAGE if self.plan.step is None else FINE_LEVERAGE

    @property
    def prefers_multipliers(self) -> bool:
        """Whether a bad partition is left for multipliers, as many constraints are coupled."""
        return (
            self.system.constraint_method == "auto" and self.watch.most_entangled > MOST_ENTANGLED
        )

    def never_lasts(self, time: float) -> bool:
        """Return whether partitions change so often that multipliers are likely to do better."""
        is_open = self.system.constraint_method == "auto"
        return is_open and self.count >= _MANY_CHANGES and self._is_brief(time)

    @property
    def looks_on_trial(self) -> int | None:
        """Looks after which a partition has lasted so long that it is compiled; None if it is."""
        step = self.plan.step
        if not self.compiles or step is None or self.kernel.backend == "compiled":
            return None
        return max(1, round(_BRIEF * step / self.plan.interval))

    def settle(self) -> None:
        """Compile the equations of a partition that has lasted."""
        parameters, equations = self.kernel.parameters, self.kernel.equations
        self.kernel = compile_kernel(equations, evaluations=np.inf).with_parameters(parameters)
        self.compiles = self.kernel.backend == "compiled"
        for best, kernel in self.known.items():
            if kernel.equations is equations:
                self.known[best] = self.kernel
                self.origins[best] = replace(self.origins[best], interpreted=False)

    def _is_brief(self, time: float) -> bool:
        """Return whether partitions change so often that another one is not compiled."""
        step = self.plan.step
        if step is None or len({*self.known, *self.origins}) < _COMPILED - 1:
            return False
        return (time - self.plan.start) / step < _BRIEF * (self.count + 1)

    @property
    def _dependent(self) -> list[str]:
        structure = self.kernel.equations.structure
        return [*structure["dependent"], *structure["rate_dependent"]]

    def pivots(self, samples: Sequence[Sample]) -> Vector:
        """Return the determinants of the loops, and of the rates where they have their own."""
        parts = [[getattr(s, name) for s in samples] for name in ("time", "state", "unknowns")]
        values = self.kernel.pivots(*parts)
        if not self.kernel.equations.structure["rate_dependent"]:
            return values
        rates = [
            self.watch.pivot(s.time, values_of(self.kernel, s), self._dependent) for s in samples
        ]
        return np.column_stack([values, rates])

    def pivot_rates(self, sample: Sample) -> Vector:
        """Return the rates of the pivots at a sample [1/s]."""
        kernel, outputs = self.kernel, values_of(self.kernel, sample)
        moving = [outputs.get(f"{u.name}_rate", 0.0) for u in kernel.equations.unknowns]
        state = sample.state + _PROBE * kernel.rates(sample.time, sample.state, sample.unknowns)
        unknowns, time = sample.unknowns + _PROBE * np.array(moving), sample.time + _PROBE
        ahead = Sample(time, state, unknowns, kernel.outputs(time, state, unknowns))
        here, there = self.pivots([sample, ahead])
        return np.asarray((there - here) / _PROBE)

    def better_at_look(self, sample: Sample, limit: float) -> PartitionComparison | None:
        """Return the same at a look, but none at a terminal event, behind which nothing follows."""
        return self.better(sample, limit) if self.plan.is_look(sample.time) else None

    def better(self, sample: Sample, limit: float) -> PartitionComparison | None:
        """Return the comparison with the best partition if that is clearly better.

        It is looked for only where the leverage is above the limit.
        """
        values = values_of(self.kernel, sample)
        leverage = self.watch.leverage(sample.time, values, self._dependent)
        # A run that diverges comes to where no rate is a number: other coordinates do no better.
        if leverage <= limit or np.isnan(leverage):
            return None
        # Near a singular position all partitions are bad; there only a much better one helps.
        is_mild = 0.0 < limit < leverage <= LEVERAGE
        if is_mild and not self.watch.is_regular(sample.time, values, _WELL_REGULAR):
            return None
        found = self.watch.compare(sample.time, values, self._dependent)
        return found if found.best_leverage < _GAIN * leverage else None

    def first_better(
        self, before: Sample | None, stop: float
    ) -> tuple[Sample, PartitionComparison] | None:
        """Return the first step between two looks at which other coordinates do clearly better.

        Steps at which determinants come below a level, which are the same with all sizes of steps,
        are looked at first.
        """
        step = self.plan.step
        if before is None or step is None:
            return None
        rows: list[Sample] = []
        count = max(1, round((stop - before.time) / step))
        with suppress(NumericalError):
            self._follow(before, stop, count, rows)
        between = rows[1:count]
        for near in [*self.log.at_levels(between), *between]:
            found = self.better(near, self.leverage)
            if found is not None and near.time > self.changed_at:
                self.refuse_late(near, found)
                return near, found
        return None

    def change_between(self, near: Sample, found: PartitionComparison) -> RestartPoint:
        """Change the partition at a look, or at a step between two; go on at the second."""
        if self.plan.is_look(near.time):
            self.log.accept(near)
            return self.change(near, found)
        kernel, here = self.derive(near, found)
        self.adopt(kernel, here, found)
        look = self.plan.index(here.time)
        rows: list[Sample] = []
        self._follow(here, self.plan.time(look), 1, rows)
        self.log.restart(here, rows[-1:])
        return RestartPoint(look, rows[-1].state, rows[-1].unknowns)

    def change(self, sample: Sample, found: PartitionComparison) -> RestartPoint:
        """Go on with other equations from a sample; return where.

        Raises
        ------
        NumericalError
            If the partition has been changed there already.
        """
        kernel, here = self.derive(sample, found)
        self.adopt(kernel, here, found)
        return RestartPoint(self.plan.index(here.time), here.state, here.unknowns)

    def derive(self, sample: Sample, found: PartitionComparison) -> tuple[Kernel, Sample]:
        """Return the kernel of another partition, and a sample in it; nothing changes yet.

        Raises
        ------
        NumericalError
            If the partition has been changed there already.
        """
        if sample.time <= self.changed_at:
            raise lasts_no_longer(sample, found)
        if found.best not in self.known and found.best not in self.origins:
            self.origins[found.best] = self.origin(
                sample, interpreted=not self.compiles or self._is_brief(sample.time)
            )
        new = self.with_dependent(found.best)
        state, guess = state_in(new, self.kernel, sample)
        unknowns = new.solve_unknowns(sample.time, state, guess)
        outputs = new.outputs(sample.time, state, unknowns)
        return new, Sample(sample.time, state, unknowns, outputs)

    def origin(self, sample: Sample, *, interpreted: bool) -> Origin:
        """Return a sample as the place where equations are derived anew."""
        return Origin.at(self.system, self.kernel, sample, self.first, interpreted=interpreted)

    def with_dependent(self, best: tuple[str, ...]) -> Kernel:
        """Return the kernel with some dependent coordinates, whose origin is known."""
        parameters = self.kernel.parameters
        if best not in self.known:
            self.plan.progress("deriving the equations with other dependent coordinates", None)
            self.known[best] = derived_from(
                self.origins[best], self.system, parameters, self.first, "partitioning"
            )
        return self.known[best].with_parameters(parameters)

    def adopt(self, kernel: Kernel, here: Sample, found: PartitionComparison) -> None:
        """Go on with a derived kernel from a sample, whatever follows."""
        self.kernel, self.changed_at, self.count = kernel, here.time, self.count + 1
        self.log.change(here)
        _log.info("t = %.6g s: '%s' is no longer dependent", here.time, found.worst)
        self.plan.happened("partition.changed", here.time)

    def refuse_late(self, sample: Sample, found: PartitionComparison) -> None:
        """Raise NumericalError where a step of fixed size has come too near to a bad partition."""
        step = self.plan.step
        if step is not None and found.leverage > _INACCURATE:
            raise NumericalError(
                f"the partition degrades within a step of {step:.3g} s at t = {sample.time:.9g} s: "
                f"'{found.worst}' moves {found.leverage:.0f} times as fast as the coordinates that "
                "determine it, and steps before are inaccurate; take a smaller step or "
                "'constraint_method: multipliers'"
            )

    def _follow(self, begin: Sample, stop: float, count: int, rows: list[Sample]) -> None:
        """Integrate from a sample with nothing watched, and keep the samples."""
        self.plan.follow(
            self.kernel,
            PieceStart(begin.time, begin.state, begin.unknowns),
            stop,
            count=count,
            parts=self.parts,
            sink=lambda *parts: rows.extend(
                Sample(float(time), *map(np.array, row)) for time, *row in zip(*parts, strict=True)
            ),
        )


def lasts_no_longer(sample: Sample, found: PartitionComparison) -> NumericalError:
    """Return the error of a motion for which no partition is good enough."""
    return NumericalError(
        f"no partition of the coordinates lasts at t = {sample.time:.9g} s; "
        f"'{found.worst}' is not determined"
    )
