"""Pass a singular configuration without looking at it: one long step from before to behind.

Where a loop is singular (a parallelogram in one line) the dependent rates are 0/0, and close to
it they are lost in rounding, as the square of the distance. The motion itself is smooth. So the
states are integrated up to a little before it, and then in one step of high order that is placed
such that the singular instant falls into the widest gap between its stages.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import NumericalError
from vehicledyn.integrate.explicit_pairs.dop853 import (
    StepStart,
    StepTolerances,
    Trial,
    first_size,
    next_size,
    try_step,
)
from vehicledyn.integrate.task import Statistics
from vehicledyn.kernel.engine import Count, Ledger
from vehicledyn.kernel.kernel import Kernel

Vector = NDArray[np.float64]

TOLERANCE, FINE_TOLERANCE = 1e-11, 1e-12
"""Relative and absolute error of the states in a step of the passage [1]."""
_COARSEST = 1e-9
"""The same that is allowed in the end: ten times as much after every few steps that are refused, as
rounding sets a limit. What needs more is no passage: at a dead point of the partition rounding is
all that is left of the step."""
_GAP = 0.47
"""Middle of the widest gap between the stages of the pair of order 8, as a part of its step."""
_MOST_TRIES, _PATIENCE = 60, 6
_STRIDES = 90
"""Steps at most in which a passage looks for a singular configuration that is not yet ahead."""
_NEARER = 0.5
"""Part of the first determinant below which a block has come near to being singular."""
_TOO_NEAR = 1e-3
"""The same part below which rounding decides where steps lead."""
_APPROACHES = 5
_PART = 0.25
"""Longest part of an interval in which determinants are not looked at."""
_MOST_STEPS = 20_000
"""Steps at most from one place of a passage to the next; one of a sampling interval needs some."""
_STALLED_STEPS, _STALLED_PART = 500, 1e-5
"""Steps that lead over less than this part of the way between two places lead nowhere."""
_PROBE = 1e-7


@dataclass(frozen=True)
class Sample:
    """Time, states, unknowns and outputs at one instant."""

    time: float
    state: Vector
    unknowns: Vector
    outputs: Vector


class Passage:
    """Integrates states and unknowns together, so that guesses of the unknowns are good.

    The unknowns that the integration carries along are a guess only: at every stage they are
    solved for, starting from it.
    """

    def __init__(
        self,
        kernel: Kernel,
        pivots: Callable[[Sequence[Sample]], Vector],
        begin: Sample,
        tolerance: float = TOLERANCE,
    ) -> None:
        """Start at a sample outside of the singular zone; ``pivots`` are those that are watched."""
        self._kernel, self._watched = kernel, pivots
        self._ledger = Ledger()
        self._n = begin.state.size
        names = [c.name for c in kernel.equations.channels]
        moving = [f"{u.name}_rate" for u in kernel.equations.unknowns]
        self._rate_of = [names.index(name) if name in names else -1 for name in moving]
        self._steps: list[Trial] = []
        self._aim = self._tolerance = tolerance
        self._move(begin.time, np.concatenate([begin.state, begin.unknowns]))

    def go(self, *, crossing: Sequence[int], until: float) -> float:
        """Integrate to behind the point where the blocks ``crossing`` become singular.

        Where they only come near to it the passage ends as far from it as it has begun.

        Returns
        -------
        float
            Time behind it [s].

        Raises
        ------
        NumericalError
            If it is not passed before the time ``until``.
        """
        first, refused, met = self._weak(crossing), 0, False
        stride = (until - self.time) / _STRIDES
        for _ in range(_MOST_TRIES + _STRIDES):
            here, wait = self._weak(crossing), self._time_to(crossing)
            nearer = np.abs(here) < _NEARER * np.abs(first)
            met = met or bool((here * first < 0.0).any() or nearer.any())
            is_far = wait <= 0.0 and bool((np.abs(here) >= np.abs(first)).all())
            if is_far and (met or self.time >= until):
                return self.time
            # A pivot may grow for a while before it falls to zero within the same interval.
            if wait <= 0.0 or (not met and wait > until - self.time):
                self.advance(self.time + (0.2 * (until - self.time) if met else stride))
                continue
            if (np.abs(here) < _TOO_NEAR * np.abs(first)).any():
                break
            tolerance = self._aim * 10.0 ** (refused // _PATIENCE)
            if tolerance < 1.5 * _COARSEST:
                self._tolerance = tolerance
                refused += 1
                if self._jump(wait / _GAP):
                    return self.time
            self.advance(self.time + min(0.15 * wait, max(0.2 * (until - self.time), 0.0)))
        raise NumericalError("the singular configuration is not passed")

    def approach(self, crossing: Sequence[int], until: float) -> Iterator[Sample]:
        """Yield samples nearer and nearer to where some blocks become singular before a time."""
        for _ in range(_APPROACHES):
            wait = self._time_to(crossing)
            if not 0.0 < wait <= until - self.time:
                return
            self.advance(self.time + 0.5 * wait)
            yield self.sample(self.time)

    def keeps_off(self, blocks: Sequence[int], least: Vector, stop: float) -> bool:
        """Integrate to a time; return whether some determinants stay above least sizes up to there.

        It ends where one does not.
        """
        first, part = np.sign(self._weak(blocks)), _PART * (stop - self.time)
        while self.time < stop:
            wait = self._time_to(blocks)
            size = min(part, 0.5 * wait) if wait > 0.0 else part
            is_last = stop - self.time < (1.0 + _PROBE) * size
            self.advance(stop if is_last else self.time + size)
            if (self._weak(blocks) * first < least).any():
                return False
        return True

    def advance(self, stop: float) -> None:
        """Integrate to a time [s] with steps of any size."""
        here, refused, tries = self._here, False, 0
        mark, is_stalled = -np.inf, False
        least = _STALLED_PART * (stop - here.time)
        size = first_size(self._rates, here, stop - here.time, _both(self._tolerance))
        while here.time < stop:
            tries += 1
            if tries > _MOST_STEPS:
                raise NumericalError(f"more than {_MOST_STEPS} steps to t = {stop:.9g} s")
            if tries % _STALLED_STEPS == 0:
                is_stalled, mark = here.time - mark < least, here.time
            if is_stalled or size < 10.0 * np.spacing(here.time):
                raise NumericalError(f"the step size became too small at t = {here.time:.9g} s")
            trial = try_step(self._rates, here, min(here.time + size, stop), _both(self._tolerance))
            size = next_size(trial, refused=refused)
            refused = not trial.error < 1.0
            if not refused:
                self._steps.append(trial)
                here = trial.end
        self._go_on_from(here)

    def sample(self, time: float) -> Sample:
        """Return a sample at a time that has been passed, from the dense output."""
        y = self._y
        if time < self.time:
            step = next(s for s in self._steps if s.begin.time <= time <= s.end.time)
            y = step.state(time)
        state = np.ascontiguousarray(y[: self._n])
        unknowns = self._solve(time, y)
        return Sample(time, state, unknowns, self._kernel.outputs(time, state, unknowns))

    def statistics(self) -> Statistics:
        """Return what the passage has taken up to now."""
        counts = self._ledger.counts
        return Statistics(
            method="dop853",
            backend=self._kernel.description,
            samples=0,
            steps=len(self._steps),
            evaluations=int(counts[Count.EVALUATIONS]),
            newton_iterations=int(counts[Count.ITERATIONS]),
            largest_residual=0.0,
            wall_seconds=0.0,
        )

    def _jump(self, size: float) -> bool:
        """Take one step of exactly this size; return whether its error is small enough."""
        trial = try_step(self._rates, self._here, self.time + size, _both(self._tolerance))
        if not trial.error < 1.0:
            return False
        self._steps.append(trial)
        self._go_on_from(trial.end)
        return True

    def _time_to(self, crossing: Sequence[int]) -> float:
        """Return the time until the first of some blocks becomes singular [s], linearly."""
        here = self._pivots(self.time, self._y)[list(crossing)]
        ahead = self._y + _PROBE * self._here.rate
        slope = (self._pivots(self.time + _PROBE, ahead)[list(crossing)] - here) / _PROBE
        waits = np.divide(-here, slope, out=np.full(here.size, -1.0), where=slope != 0.0)
        coming = waits[waits > 0.0]
        return float(coming.min()) if coming.size else -1.0

    def _weak(self, crossing: Sequence[int]) -> Vector:
        """Return the determinants of some blocks here."""
        return self._pivots(self.time, self._y)[list(crossing)]

    def _pivots(self, time: float, y: Vector) -> Vector:
        state, unknowns = np.ascontiguousarray(y[: self._n]), y[self._n :].copy()
        outputs = self._kernel.outputs(time, state, unknowns)
        return self._watched([Sample(time, state, unknowns, outputs)]).ravel()

    def _rates(self, time: float, y: Vector) -> Vector:
        """Return the rates of states and unknowns; not a number where a loop cannot close."""
        state, unknowns = np.ascontiguousarray(y[: self._n]), y[self._n :].copy()
        try:
            rates = self._kernel.evaluate(time, state, unknowns, self._ledger)
        except NumericalError:
            return np.full(y.size, np.nan)
        outputs = self._kernel.outputs(time, state, unknowns)
        moving = [outputs[k] if k >= 0 else 0.0 for k in self._rate_of]
        return np.concatenate([rates, moving])

    def _go_on_from(self, point: StepStart) -> None:
        """Be at the end of a step, with the unknowns solved there."""
        state = np.ascontiguousarray(point.state[: self._n])
        unknowns = self._solve(point.time, point.state)
        self._move(point.time, np.concatenate([state, unknowns]))

    def _move(self, time: float, y: Vector) -> None:
        self.time, self._y = time, y
        self._here = StepStart(time, y, self._rates(time, y))

    def _solve(self, time: float, y: Vector) -> Vector:
        state = np.ascontiguousarray(y[: self._n])
        return self._kernel.count_solve(time, state, y[self._n :], self._ledger)


def _both(tolerance: float) -> StepTolerances:
    return StepTolerances(tolerance, tolerance)
