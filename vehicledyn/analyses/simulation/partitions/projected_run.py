"""Simulate constrained motion with multipliers: put the states back, watch the Jacobian's rank.

The equations project the states wherever they are evaluated; so that drift stays small, runs go
in pieces, each of which begins on the constraints, with what the method carries from step to
step: begun anew so often, implicit methods would be of order one. Between two looks at the motion
the sign of det(J J'ᵀ), J' being the Jacobian of the look before, says whether it has lost its rank:
it is positive for any small change but one through a singular configuration.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyses.preparation.projection import projected
from vehicledyn.analyses.simulation.partitions.rederived import values_of
from vehicledyn.analyses.simulation.partitions.singularity_crossing import Sample
from vehicledyn.analyses.simulation.run_plan import PieceStart, RunPlan
from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.accuracy.divergence import DivergenceError
from vehicledyn.integrate.course import MethodState, RunHistory, reading_history
from vehicledyn.integrate.task import Statistics, joined
from vehicledyn.kernel.kernel import Kernel

if TYPE_CHECKING:
    from vehicledyn.multibody.loops.partition_monitor import PartitionMonitor

Vector = NDArray[np.float64]

_LOOKS = 16
"""Most looks at a motion in a piece of it."""
_STEPS = 20
"""Steps of a fixed size between looks."""
_DEPENDENT = 1e-10
"""Squared sine of the angle between a constraint and others below which it depends on them [1]."""
_SHARE = 0.3
_DENSE = 60
"""Rows up to which a determinant is found by dense elimination."""


@dataclass
class ProjectedRun:
    """A run of equations with multipliers, from one sample on to the end."""

    kernel: Kernel
    plan: RunPlan
    make_watch: Callable[[], PartitionMonitor]
    course: RunHistory | None = None
    _delivered: int = field(default=0, init=False)
    _parts: list[Statistics] = field(default_factory=list, init=False)
    _last: Sample | None = field(default=None, init=False)
    _jacobian: Vector | None = field(default=None, init=False)
    _is_first: bool = field(default=True, init=False)
    _carried: MethodState = field(default_factory=MethodState, init=False)

    @cached_property
    def _watch(self) -> PartitionMonitor:
        return self.make_watch()

    def go_on(self, history: Vector, n_states: int, n_unknowns: int) -> Statistics:
        """Run to the end from what was noted where a piece began."""
        with reading_history():
            state, unknowns, numbers = np.split(history, [n_states, n_states + n_unknowns])
            if len(history) < n_states + n_unknowns or not np.isfinite(history).all():
                raise ValueError("too few numbers, or not finite")
        self._carried.numbers = numbers if len(numbers) else None
        return self.go(state, unknowns, skip=True)

    def go(self, state: Vector, unknowns: Vector, *, skip: bool = False) -> Statistics:
        """Run to the end; the first sample is not handed on if ``skip``.

        Raises
        ------
        NumericalError
            If the integration cannot go on; constraints that become dependent are named.
        """
        first, count = self._first_look(), self.plan.n_looks
        self._is_first = not skip
        while True:
            last = self._last_look(first)
            found = self._piece(first, last, state, unknowns)
            if found.ended_by or last >= count:
                return replace(joined(self._parts), samples=self._delivered)
            first = last
            state, unknowns = self._projected()

    def _first_look(self) -> int:
        beginning = None if self.course is None else self.course.beginning
        return 0 if beginning is None else self.plan.index(beginning.time)

    def _last_look(self, first: int) -> int:
        """Return the end of a piece; among those of a run are samples that it can go on from."""
        group = self.plan.every * max(1, _LOOKS // self.plan.every)
        return min(self.plan.n_looks, first + _LOOKS, (first // group + 1) * group)

    def _note(self, begin: PieceStart) -> None:
        """Note where a piece begins if that is a sample: a run in one piece begins it there too."""
        if self.course is not None and self.plan.is_wanted(begin.time):
            numbers = self._carried.numbers
            parts = [begin.state, begin.unknowns, *([] if numbers is None else [numbers])]
            self.course.note(begin.time, np.concatenate(parts))

    def _piece(self, first: int, last: int, state: Vector, unknowns: Vector) -> Statistics:
        plan = self.plan
        point = PieceStart(plan.time(first), state, unknowns)
        self._note(point)

        def take(times: Vector, x: Vector, z: Vector, y: Vector) -> None:
            wanted = plan.is_wanted(times)
            if not self._is_first:
                wanted &= times > point.time + 0.5 * plan.interval
            for k in range(len(times)):
                self._look(times[k], x[k], z[k], y[k])
            self._delivered += int(wanted.sum())
            if wanted.any():
                plan.sink(self.kernel, times[wanted], x[wanted], z[wanted], y[wanted])

        try:
            return plan.integrate(
                self.kernel,
                point,
                plan.time(last),
                sink=take,
                parts=self._parts,
                progress=self._report,
                carried=self._carried,
            )
        except DivergenceError:
            raise
        except NumericalError as error:
            weak = self._weak()
            raise NumericalError(f"{error}; {weak}" if weak else str(error)) from None
        finally:
            self._is_first = False

    def _report(self, what: str, part: float | None) -> None:
        self.plan.report(what, part, None if self._last is None else self._last.time)

    def _look(self, time: float, state: Vector, unknowns: Vector, outputs: Vector) -> None:
        """Keep a sample; raise NumericalError if the constraints lost their rank before it."""
        sample = Sample(float(time), state.copy(), unknowns.copy(), outputs.copy())
        start, before, now = self._last, self._jacobian, self._scaled_jacobian(sample)
        self._last, self._jacobian = sample, now
        if start is None or before is None or not len(before) or not len(now):
            return
        if _is_positive(now, before):
            return
        if self._is_crossed(start, before, float(time)):
            raise NumericalError(
                f"the constraints lose their rank before t = {time:.9g} s: {self._named(now)}; the "
                "motion is not unique there, let it start elsewhere or take 'constraint_method: "
                "partitioning', which passes singular configurations"
            )

    def _is_crossed(self, start: Sample, before: Vector, stop: float) -> bool:
        """Return whether the rank is lost between two looks, which may be far apart: look closer.

        Short rods may turn by more than a right angle between looks, which is no loss of rank.
        """
        if stop - start.time < 1e-12:
            return False
        step = self.plan.step
        count = _STEPS if step is None else max(1, round((stop - start.time) / step))
        outputs = self.kernel.outputs(start.time, start.state, start.unknowns)
        state = projected(self.kernel, start.state, outputs)
        jacobians = [before]

        def take(times: Vector, x: Vector, z: Vector, y: Vector) -> None:
            rows = zip(times, x, z, y, strict=True)
            jacobians.extend(self._scaled_jacobian(Sample(*row)) for row in rows)

        begin = PieceStart(start.time, state, start.unknowns)
        self.plan.follow(self.kernel, begin, stop, count=count, parts=self._parts, sink=take)
        return not all(_is_positive(b, a) for a, b in pairwise(jacobians))

    def _scaled_jacobian(self, sample: Sample | None) -> Vector:
        """Return the Jacobian of the kept rows at a sample, its rows of length one.

        There are none where a motion that diverges makes them too large.
        """
        if sample is None:
            return np.zeros((0, 0))
        rows = self._watch.independent_rows(sample.time, values_of(self.kernel, sample))
        with np.errstate(all="ignore"):
            lengths = np.linalg.norm(rows, axis=1, keepdims=True)
        if not np.isfinite(lengths).all():
            return np.zeros((0, 0))
        return np.asarray(rows / np.where(lengths > 0.0, lengths, 1.0))

    def _weak(self) -> str:
        """Return which constraints hardly differ at the last sample, if any."""
        rows = self._scaled_jacobian(self._last)
        if not len(rows) or np.linalg.svd(rows, compute_uv=False)[-1] ** 2 > _DEPENDENT:
            return ""
        return self._named(rows)

    def _named(self, rows: Vector) -> str:
        shares = np.abs(np.linalg.svd(rows)[0][:, -1])
        cuts = self._watch.cuts_of_rows
        found = [cuts[k] for k in np.argsort(-shares) if shares[k] > _SHARE * shares.max()]
        listed = ", ".join(f"'{name}'" for name in dict.fromkeys(found))
        return f"those of {listed} depend on each other"

    def _projected(self) -> tuple[Vector, Vector]:
        """Return the last sample with its states on the constraints, where steps leave them."""
        if self._last is None:
            raise ValueError("no sample has been taken yet")
        if self._carried.holds_constraints:
            return self._last.state, self._last.unknowns
        state = projected(self.kernel, self._last.state, self._last.outputs)
        return state, self._last.unknowns


def projected_plan(plan: RunPlan) -> RunPlan:
    """Return a plan with looks between its samples that are close enough for the rank."""
    return plan.looked_at(steps=_STEPS)


def _is_positive(now: Vector, before: Vector) -> bool:
    """Return whether det(J J'ᵀ) is positive."""
    from scipy.sparse import csr_matrix
    from scipy.sparse.linalg import splu

    product = csr_matrix(now) @ csr_matrix(before).T
    if len(now) <= _DENSE:
        return bool(np.linalg.slogdet(product.toarray())[0] > 0.0)
    try:
        factors = splu(product.tocsc())
    except RuntimeError:
        return False
    sign = np.prod(np.sign(factors.U.diagonal())) * np.prod(np.sign(factors.L.diagonal()))
    return bool(sign * _parity(factors.perm_r) * _parity(factors.perm_c) > 0.0)


def _parity(order: Any) -> int:
    """Return 1 or -1, the sign of a permutation."""
    sign, seen = 1, np.zeros(len(order), dtype=bool)
    for k in range(len(order)):
        length, at = 0, k
        while not seen[at]:
            seen[at] = True
            at, length = int(order[at]), length + 1
        if length and length % 2 == 0:
            sign = -sign
    return sign
