"""Steps in which laws have corners are divided there, so that derivatives are those of the motion.

A step over a corner evaluates its laws on both sides, so that its own derivatives miss those of
the motion by as much as it is long, however exact they are elsewhere. Here the motion is divided
where a law changes its branch, in parts that get shorter towards it, so that no stage reaches over
it. Where the rates themselves jump, by Δf, at an instant t that moves by

    dt/dp = -(dg/dp) / (dg/dt)

for the function g that decides between the branches, the tangents jump by -Δf dt/dp.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.gradients.corner_functions import CornerFunctions
from vehicledyn.analyse.gradients.corner_watch import CornerWatch
from vehicledyn.integrate.events import ConsistentPoint
from vehicledyn.kernel.bundle import Bundle
from vehicledyn.kernel.engine import March, Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.tangent_code import MotionPoint, StepRow, StepSpan, TangentCode

Matrix = NDArray[np.float64]

_MOST_IN_STEP = 16
_CLOSE = 1e-8
"""Part of a step that is kept from a corner."""
_SHORTER, _PARTS = 0.05, 6
"""By how much parts get shorter towards a corner, and their number."""
_NEGLIGIBLE, _LOUD = 1e-3, (1e-7, 1e-10)
"""Part of the change of rates by which this jumps at a corner that is felt, and parts of rates and
of states that it has in a step at least."""
_ASIDE = 1e-4
"""Part of a step over which the change of rates is taken."""
_SMALLEST = 1e-6
"""Size of a state, in SI units, below which nobody asks by what part of it a step misses."""
_JUMP = 1e-6
"""Part of the rates by which they jump, if they do."""
_APART = 1e-5
"""Part of a function's change behind an event from which on it is not zero at this."""
_RESOLUTION, _MOST_TRIALS = 0.1 * _CLOSE, 100

Trial = Callable[[float], ConsistentPoint]


@dataclass(frozen=True)
class StepParts:
    """How the step that is due is taken in parts, which its fractions begin and end.

    ``trials`` returns the motion from the fraction that is reached on; ``part`` takes the tangents
    through a part and returns its end, and ``enter`` makes a point the one that is reached.
    """

    trials: Callable[[float], Trial]
    part: Callable[[tuple[float, float]], ConsistentPoint]
    enter: Callable[[ConsistentPoint], None]


class CornerSteps:
    """Finds the steps with corners ahead of a motion, and takes its tangents through them.

    ``jumped`` says whether rates jumped in the last one.

    Parameters
    ----------
    kernel, code
        The model and its compiled derivatives.
    bundle
        The tangents that are carried, by ``n_directions`` and maybe by time behind them.
    by_parameter
        Tangents of the parameters (n_parameters, n_directions).
    """

    def __init__(
        self, kernel: Kernel, code: TangentCode, bundle: Bundle, by_parameter: Matrix
    ) -> None:
        self._functions = CornerFunctions(code.branches)
        self._kernel, self._code, self._bundle = kernel, code, bundle
        self._by_parameter, self._parameters = by_parameter, kernel.parameters
        self._constants = code.constants(self._parameters)
        self._plain = Bundle(code, np.zeros((code.n_constants, 0)))
        self.watch = CornerWatch(code, self._parameters, self._plain)
        self._values = self.watch.values
        self._marks = self.watch.branches.branches
        self.jumped = False

    def whole(self, march: March) -> ConsistentPoint | None:
        """Return where the step that is due ends as a whole, None if it cannot be taken."""
        moment = MotionPoint(
            march.time(march.step), march.state.copy(), march.unknowns.copy(), self._constants
        )
        grid = StepRow(march.method, march.start, march.interval, march.per_interval)
        taken = self._plain.march(grid, StepSpan(march.step, 1), moment, march.sides.copy())[1]
        end = ConsistentPoint(march.time(march.step + 1), moment.state, moment.unknowns)
        return end if taken else None

    def behind(
        self, trial: Trial, of: tuple[float, float], ends: tuple[ConsistentPoint, ConsistentPoint]
    ) -> float | None:
        """Return the fraction behind the first corner within a part of a step, None without one.

        A part that begins within a step begins at an event, at which laws may have corners too.
        """
        if self.watch.structure is None:
            return None
        values = self._values(ends[0]), self._values(ends[1])
        marks = self._marks(values[0])
        changed = self._differs(values[1], marks)
        near = np.abs(values[0]) <= _APART * np.abs(values[1] - values[0])
        if of[0] > 0.0 and (changed & near).any():
            return None
        if (changed & self.watch.branches.skipped).any():
            return None
        found = self._first(trial, of, marks, values)
        return None if found is None else min(found + _CLOSE, of[1])

    def divided(
        self,
        step: int,
        parts: StepParts,
        ends: tuple[ConsistentPoint, ConsistentPoint],
        of: tuple[float, float] = (0.0, 1.0),
    ) -> ConsistentPoint | None:
        """Take the tangents through a step, divided at its corners, and return its end.

        None if no corner is felt, or the motion does not pass it; what is carried is then of no
        use.

        Parameters
        ----------
        step
            Its number.
        parts
            How it is taken in parts, from where it begins.
        ends
            Where it begins, and where it ends as a whole.
        of
            The fractions that it begins and ends at.
        """
        self.jumped = False
        (fraction, last), watch, (here, end), count = of, self.watch, ends, 0
        values = self._values(here), self._values(end)
        marks = self._marks(values[0])
        either = (marks == 0.0) | (watch.resting & (step == 0 and fraction == 0.0))
        marks = np.where(either, self._marks(values[1]), marks)
        trial = parts.trials(fraction)
        for _ in range(_MOST_IN_STEP):
            corner = self._first(trial, (fraction, last), marks, values)
            if corner is None:
                return parts.part((fraction, last)) if count else None
            span = max(corner - _CLOSE, fraction), min(corner + _CLOSE, last)
            values_there = self._values(trial(span[1]))
            later = self._marks(values_there)
            changed = (later != marks) & (later != 0.0)
            if self._is_felt(trial, fraction, span):
                self._approach(parts, fraction, span[0])
                over = self._over(parts, *span)
                if over is None:
                    return None
                here, fraction, count = over, span[1], count + 1
                watch.weak[changed] = 0.0
                if fraction >= last:
                    return here
                trial = parts.trials(fraction)
                end = trial(last)
                values = values_there, self._values(end)
            else:
                watch.weak[changed & watch.felt] += 1.0
            marks = np.where(changed, later, marks)
        return None

    def missed(self, divided: ConsistentPoint, whole: ConsistentPoint) -> float:
        """Return by what part of a state's size a whole step misses the divided one."""
        sizes = np.maximum(self.watch.sizes, np.maximum(np.abs(divided.state), _SMALLEST))
        return float(np.max(np.abs(divided.state - whole.state) / sizes))

    def _is_felt(self, trial: Trial, begin: float, span: tuple[float, float]) -> bool:
        """Return whether the rates jump at a corner, or their change with time does."""
        aside = span[0] - _ASIDE, span[0], span[1], span[1] + _ASIDE
        if aside[0] < begin or aside[-1] > 1.0:
            return True
        points = [trial(fraction) for fraction in aside]
        rates = np.array([self._kernel.rates(*point) for point in points])
        step = (points[-1].time - points[0].time) / (aside[-1] - aside[0])
        before, after = (
            (rates[k + 1] - rates[k]) / (points[k + 1].time - points[k].time) for k in (0, 2)
        )
        least = _LOUD[0] * np.abs(rates[1]) / step + _LOUD[1] * self.watch.sizes / step**2
        least = least + _NEGLIGIBLE * (np.abs(before) + np.abs(after))
        jump = (
            np.abs(rates[2] - rates[1])
            > _JUMP * np.abs(rates[1]) + _LOUD[1] * self.watch.sizes / step
        )
        return bool(np.any(jump | (np.abs(after - before) > least)))

    def _first(
        self,
        trial: Trial,
        span: tuple[float, float],
        marks: Vector,
        ends: tuple[Vector, Vector],
    ) -> float | None:
        """Return the fraction behind the first change of a branch (Illinois method).

        ``ends`` are the functions at the fraction that is reached and at the last one.
        """
        low, high = span
        below, above = ends
        changed = self._differs(above, marks)
        if not changed.any():
            return None
        edges = np.where(above > below, marks, marks - 1.0) * self._functions.is_table
        below, above, was_high, halve = below - edges, above - edges, False, False
        for _ in range(_MOST_TRIALS):
            if high - low <= _RESOLUTION:
                break
            size, guess = high - low, 0.5 * (low + high)
            if not halve and np.all(below[changed] * above[changed] < 0.0):
                shares = below[changed] / (below[changed] - above[changed])
                guess = low + size * float(np.min(shares))
            guess = min(max(guess, low + 0.5 * _RESOLUTION), high - 0.5 * _RESOLUTION)
            values = self._values(trial(guess))
            there = self._differs(values, marks)
            if there.any():
                below = below * 0.5 if was_high else below
                high, above, changed, was_high = guess, values - edges, there, True
            else:
                above = above if was_high else above * 0.5
                low, below, was_high = guess, values - edges, False
            halve = high - low > 0.5 * size
        return high

    def _differs(self, values: Vector, marks: Vector) -> NDArray[np.bool_]:
        found = self._marks(values)
        return np.asarray((found != marks) & (found != 0.0) & self.watch.felt)

    @staticmethod
    def _approach(parts: StepParts, begin: float, near: float) -> None:
        """Take parts that get shorter towards a fraction."""
        ends = near - (near - begin) * _SHORTER ** np.arange(1.0, _PARTS)
        for end in map(float, (*ends, near)):
            if end > begin:
                parts.enter(parts.part((begin, end)))
            begin = end

    def _over(self, parts: StepParts, near: float, behind: float) -> ConsistentPoint | None:
        """Take the tangents over a corner; return the point behind it, None if they have none."""
        trial = parts.trials(near)
        before, after = trial(near), trial(behind)
        rates = [self._kernel.rates(*point) for point in (before, after)]
        jump = rates[1] - rates[0]
        size = max(float(np.max(np.abs(item) / self.watch.sizes)) for item in rates)
        if float(np.max(np.abs(jump) / self.watch.sizes)) > _JUMP * size:
            moved = self._moved((before, after), rates)
            if moved is None:
                return None
            self.jumped = True
            tangents = self._bundle.state
            jump[np.abs(jump) <= _JUMP * np.abs(rates[0])] = 0.0
            tangents[:, : len(moved)] -= np.outer(jump, moved)
            self._bundle.state = tangents
        parts.enter(parts.part((near, behind)))
        return after

    def _moved(
        self, points: tuple[ConsistentPoint, ConsistentPoint], rates: list[Vector]
    ) -> Vector | None:
        """Return how the instant of a jump moves (n_directions,) [s]; None if it is not passed."""
        marks = [self._marks(self._values(point)) for point in points]
        which = np.flatnonzero((marks[0] != marks[1]) & self.watch.felt)
        if not which.size:
            return None
        given = *points[0], self._parameters
        by_time, by_state, by_unknown, by_parameter = self._functions.slopes(int(which[0]), *given)
        passing = [float(by_time[0] + by_state @ item) for item in rates]
        n = self._by_parameter.shape[1]
        slope = by_state @ self._bundle.state[:, :n] + by_parameter @ self._by_parameter
        if by_unknown.any():
            found = self._bundle.here(MotionPoint(*points[0], self._constants))
            slope = slope + by_unknown @ found.unknown_slopes[0][:, :n]
            for k, item in enumerate(rates):
                passing[k] += float(by_unknown @ self._unknown_rates(points[k], item))
        if not passing[0] * passing[1] > 0.0:
            return None
        return np.asarray(-slope / passing[0])

    def _unknown_rates(self, point: ConsistentPoint, rates: Vector) -> Vector:
        """Return the rates of the unknowns."""
        along = Bundle(self._code, np.zeros((self._code.n_constants, 1)))
        along.state = rates[:, None]
        moment = MotionPoint(*point, self._constants)
        return np.asarray(along.here(moment, np.ones(1)).unknown_slopes[0][:, 0])
