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
from vehicledyn.integrate.events import ConsistentPoint
from vehicledyn.kernel.bundle import Bundle
from vehicledyn.kernel.engine import March, Method, SampleRows, Vector
from vehicledyn.kernel.kernel import Kernel
from vehicledyn.kernel.tangent_code import MotionPoint, StepRow, StepSpan, TangentCode

Matrix = NDArray[np.float64]

_MOST_AHEAD = 4096
"""Steps that are looked through at once."""
_NOISE = 1e-9
"""Part of a function's range that it changes by in a step, if not by rounding."""
_OFTEN, _FEW = 0.1, 16
"""Part of the steps, and their number, up to which one function may change its branch in them, and
up to which all may together: where contacts rattle, corners are all over the motion."""
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
_MOST_WEAK = 2
"""How often a function may change its branch without being felt until it is passed over."""
_JUMP = 1e-6
"""Part of the rates by which they jump, if they do."""
_RESOLUTION, _MOST_TRIALS = 1e-12, 100

Trial = Callable[[float], ConsistentPoint]


@dataclass(frozen=True)
class StepParts:
    """How the step that is due is taken in parts, which its fractions begin and end.

    ``trials`` returns the motion from the fraction that is reached on; ``part`` takes the tangents
    through a part, and ``enter`` makes a point the one that is reached.
    """

    trials: Callable[[float], Trial]
    part: Callable[[tuple[float, float]], None]
    enter: Callable[[ConsistentPoint], None]


def has_corners(kernel: Kernel, grid: StepRow) -> bool:
    """Return whether steps of a model are divided where they pass corners of its laws."""
    return grid.method == Method.RK4 and _functions(kernel).count > 0


def _functions(kernel: Kernel) -> CornerFunctions:
    """Return the functions of corners, made once for all kernels of a model."""
    key = "functions of corners"
    if key not in kernel.made:
        kernel.made[key] = CornerFunctions(kernel.equations)
    found = kernel.made[key]
    if not isinstance(found, CornerFunctions):
        raise TypeError(key)
    return found


class CornerSteps:
    """Finds the steps with corners ahead of a motion, and takes its tangents through them.

    ``jumped`` says whether rates jumped in the last one, ``left_whole`` whether there are so many
    steps with corners that these are not divided.

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
        self._functions = _functions(kernel)
        self._kernel, self._code, self._bundle = kernel, code, bundle
        self._by_parameter, self._parameters = by_parameter, kernel.parameters
        self._constants = code.constants(self._parameters)
        self._plain = Bundle(code, np.zeros((code.n_constants, 0)))
        self._sizes = np.ones(len(kernel.equations.states))
        self._weak = np.zeros(self._functions.count)
        self._resting = np.zeros(self._functions.count, dtype=bool)
        self.jumped = self.left_whole = False
        self.forget()

    def forget(self) -> None:
        """Look ahead anew from the next step on."""
        self._until = -1
        self._steps: dict[int, NDArray[np.intp]] = {}

    @property
    def memory(self) -> Vector:
        """What is known of the functions: how often each was not felt."""
        return self._weak.copy()

    def recall(self, memory: Vector) -> None:
        """Set what :attr:`memory` returned, where it is of the same equations."""
        if memory.shape == self._weak.shape:
            self._weak[:] = memory

    @property
    def _felt(self) -> NDArray[np.bool_]:
        return self._weak < _MOST_WEAK

    def ahead(self, march: March, most: int) -> int:
        """Return how many steps, up to the most, have no corners from the next one on."""
        if not self._functions.count:
            return most
        if not march.step < self._until:
            self._look(march, most)
        if march.method != Method.RK4:
            self.left_whole |= bool(self._steps)
            return min(most, self._until - march.step)
        for step, which in self._steps.items():
            if step >= march.step and self._felt[which].any():
                return min(most, step - march.step)
        return min(most, self._until - march.step)

    def _look(self, march: March, most: int) -> None:
        """Find the steps ahead in which functions change their branch."""
        count = min(most, _MOST_AHEAD)
        time, step = march.time(march.step), march.interval / march.per_interval
        states, unknowns = self._ahead(march, count + 1)
        times = np.asarray(time + step * np.arange(len(states)), dtype=float)
        values = self._functions.along(times, states, unknowns, self._parameters)
        changed = self._changed(values, begins=march.step == 0)[:count]
        self._until = march.step + count
        rows = np.flatnonzero(changed.any(axis=1))
        self._steps = {march.step + int(row): np.flatnonzero(changed[row]) for row in rows}
        sizes = np.abs(states).max(axis=0)
        self._sizes = np.where(sizes > 0.0, sizes, 1.0)

    def _ahead(self, march: March, count: int) -> tuple[Matrix, Matrix]:
        """Return states and unknowns of the next steps, as they are taken as a whole."""
        time, step = march.time(march.step), march.interval / march.per_interval
        begin = march.state.copy(), march.unknowns.copy()
        if self._kernel.key:
            e, method = self._kernel.equations, march.method
            ahead = March(method, time, step, 1, *begin, sides=march.sides.copy())
            sizes = len(e.states), len(e.unknowns), len(e.channels)
            room = SampleRows(*[np.empty((count + 1, size)) for size in sizes])
            self._kernel.advance(ahead, count, room)
            rows = room.states[: ahead.step], room.unknowns[: ahead.step]
        else:
            grid, way = StepRow(march.method, time, step, 1), StepSpan(0, count)
            moment = MotionPoint(time, begin[0].copy(), begin[1].copy(), self._constants)
            rows = self._plain.march(grid, way, moment, march.sides.copy())[2][1:3]
        return (
            np.concatenate([begin[0][None], rows[0]]),
            np.concatenate([begin[1][None], rows[1]]),
        )

    def _changed(self, values: Matrix, *, begins: bool) -> NDArray[np.bool_]:
        """Return in which steps which functions change, rounding and rattling left out.

        Where the motion begins at a corner up to rounding, it does not pass it.
        """
        is_table = self._functions.is_table
        changed = np.zeros((len(values) - 1, values.shape[1]), dtype=bool)
        moving = np.flatnonzero((np.diff(values > 0.0, axis=0)).any(axis=0) | is_table)
        values = values[:, moving]
        marks = self._marks(values, moving)
        with np.errstate(invalid="ignore"):
            sizes = np.max(np.abs(values), axis=0, initial=0.0)
            moved = np.abs(np.diff(values, axis=0)) > _NOISE * sizes
            rests = (np.abs(values[0]) <= _NOISE * sizes) & ~is_table[moving]
        self._resting[:] = False
        if begins:
            self._resting[moving], marks[0, rests] = rests, 0.0
        rows = np.arange(len(marks))[:, None]
        known = np.where(marks != 0.0, rows, len(marks) - 1)
        behind = np.minimum.accumulate(known[::-1], axis=0)[::-1]
        marks = np.take_along_axis(marks, behind, axis=0)
        found = (np.diff(marks, axis=0) != 0.0) & moved
        often = found.sum(axis=0) > max(_FEW, _OFTEN * len(found))
        changed[:, moving] = found & ~often
        felt = changed & self._felt
        all_over = felt.any(axis=1).sum() > _FEW and felt.sum() > _OFTEN * len(found)
        if all_over:
            changed[:] = False
        self.left_whole |= bool(all_over or often.any())
        return changed

    def _marks(self, values: Matrix, which: NDArray[np.intp] | slice = slice(None)) -> Matrix:
        """Return which branch functions choose; 0 where it is either."""
        is_table = self._functions.is_table[which]
        marks = np.where(is_table, np.floor(values) + 1.0, np.sign(values))
        return np.nan_to_num(marks)

    def _values(self, point: ConsistentPoint) -> Vector:
        return self._functions.at(*point, self._parameters)

    def whole(self, march: March) -> ConsistentPoint | None:
        """Return where the step that is due ends as a whole, None if it cannot be taken."""
        moment = MotionPoint(
            march.time(march.step), march.state.copy(), march.unknowns.copy(), self._constants
        )
        grid = StepRow(march.method, march.start, march.interval, march.per_interval)
        taken = self._plain.march(grid, StepSpan(march.step, 1), moment, march.sides.copy())[1]
        end = ConsistentPoint(march.time(march.step + 1), moment.state, moment.unknowns)
        return end if taken else None

    def divided(
        self, step: int, parts: StepParts, ends: tuple[ConsistentPoint, ConsistentPoint]
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
        """
        del self._steps[step]
        self.jumped = False
        fraction, here, count = 0.0, ends[0], 0
        marks = self._marks(self._values(here))
        either = (marks == 0.0) | (self._resting & (step == 0))
        marks = np.where(either, self._marks(self._values(ends[1])), marks)
        for _ in range(_MOST_IN_STEP):
            trial = parts.trials(fraction)
            corner = self._first(trial, fraction, marks) if fraction < 1.0 else None
            if corner is None:
                return self._last(parts, fraction, here) if count else None
            span = max(corner - _CLOSE, fraction), min(corner + _CLOSE, 1.0)
            later = self._marks(self._values(trial(span[1])))
            changed = (later != marks) & (later != 0.0)
            if self._is_felt(trial, fraction, span):
                self._approach(parts, fraction, span[0])
                over = self._over(parts, *span)
                if over is None:
                    return None
                here, fraction, count = over, span[1], count + 1
                self._weak[changed] = 0.0
            else:
                self._weak[changed & self._felt] += 1.0
            marks = np.where(changed, later, marks)
        return None

    def _last(self, parts: StepParts, fraction: float, here: ConsistentPoint) -> ConsistentPoint:
        if fraction >= 1.0:
            return here
        end = parts.trials(fraction)(1.0)
        parts.part((fraction, 1.0))
        return end

    def missed(self, divided: ConsistentPoint, whole: ConsistentPoint) -> float:
        """Return by what part of a state's size a whole step misses the divided one."""
        return float(np.max(np.abs(divided.state - whole.state) / self._sizes))

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
        least = _LOUD[0] * np.abs(rates[1]) / step + _LOUD[1] * self._sizes / step**2
        least = least + _NEGLIGIBLE * (np.abs(before) + np.abs(after))
        jump = (
            np.abs(rates[2] - rates[1]) > _JUMP * np.abs(rates[1]) + _LOUD[1] * self._sizes / step
        )
        return bool(np.any(jump | (np.abs(after - before) > least)))

    def _first(self, trial: Trial, fraction: float, marks: Vector) -> float | None:
        """Return the fraction behind the first change of a branch (Illinois method)."""
        low, high = fraction, 1.0
        below, above = self._values(trial(low)), self._values(trial(high))
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
        return np.asarray((found != marks) & (found != 0.0) & self._felt)

    def _approach(self, parts: StepParts, begin: float, near: float) -> None:
        """Take parts that get shorter towards a fraction."""
        ends = near - (near - begin) * _SHORTER ** np.arange(1.0, _PARTS)
        for end in (*ends, near):
            self._pass(parts, begin, float(end))
            begin = float(end)

    @staticmethod
    def _pass(parts: StepParts, begin: float, end: float) -> None:
        if end > begin:
            point = parts.trials(begin)(end)
            parts.part((begin, end))
            parts.enter(point)

    def _over(self, parts: StepParts, near: float, behind: float) -> ConsistentPoint | None:
        """Take the tangents over a corner; return the point behind it, None if they have none."""
        trial = parts.trials(near)
        before, after = trial(near), trial(behind)
        rates = [self._kernel.rates(*point) for point in (before, after)]
        jump = rates[1] - rates[0]
        size = max(float(np.max(np.abs(item) / self._sizes)) for item in rates)
        if float(np.max(np.abs(jump) / self._sizes)) > _JUMP * size:
            moved = self._moved((before, after), rates)
            if moved is None:
                return None
            self.jumped = True
            tangents = self._bundle.state
            tangents[:, : len(moved)] -= np.outer(jump, moved)
            self._bundle.state = tangents
        self._pass(parts, near, behind)
        return after

    def _moved(
        self, points: tuple[ConsistentPoint, ConsistentPoint], rates: list[Vector]
    ) -> Vector | None:
        """Return how the instant of a jump moves (n_directions,) [s]; None if it is not passed."""
        marks = [self._marks(self._values(point)) for point in points]
        which = np.flatnonzero((marks[0] != marks[1]) & self._felt)
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
