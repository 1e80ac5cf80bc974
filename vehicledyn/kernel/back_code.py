"""Adjoints of a motion: one number's derivatives by everything, for the price of a few runs.

The motion is kept at the stages of its steps; of long ones only some begins of steps are kept, and
the others computed again from these, so that memory stays bounded.
"""

from __future__ import annotations

from collections.abc import Callable, Collection
from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np
from numpy.typing import NDArray

from vehicledyn.kernel.bundle import Bundle, Samples
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.plans import BackSums, SlopeMap, passes
from vehicledyn.kernel.tangent_code import StepRow, TangentCode, steps_of

_MOST_BYTES = 64_000_000
"""Memory for steps that are kept, above which only some are."""

_STAGES = 4
"""Stages of a step."""


_Stages = tuple[Vector, Vector, Vector]
"""States, unknowns and accelerations of stages, one row each."""


@dataclass(frozen=True)
class Record:
    """A motion on the way back: states and unknowns at the begin of every ``stride`` steps.

    ``stages`` are those of all stages, with their accelerations, None where they are too many to be
    kept. ``samples`` are the points where intervals begin, and the end; ``n_bytes`` is what is kept
    of the others.
    """

    n_steps: int
    stride: int
    states: NDArray[np.float64]
    unknowns: NDArray[np.float64]
    stages: _Stages | None
    samples: Samples
    n_bytes: int


@dataclass(frozen=True)
class ReplacedStep:
    """A step that is taken in another way: where it ends, and the derivatives of that.

    ``by_state`` (n_states, n_states) and ``by_parameter`` (n_states, n_parameters).
    """

    state: Vector
    unknowns: Vector
    by_state: NDArray[np.float64]
    by_parameter: NDArray[np.float64]


@dataclass(frozen=True)
class ReplacedSteps:
    """Steps that are taken in another way, and what takes one from its states and unknowns."""

    steps: Collection[int]
    taken: Callable[[int, Vector, Vector], ReplacedStep]


class BackCode:
    """Adjoints of a motion with steps of rk4.

    Parameters
    ----------
    code
        Compiled derivatives, made with ``back``.
    grid
        The steps.
    constants
        What depends on the parameters alone.
    passages
        Steps that are taken in another way.
    """

    def __init__(
        self,
        code: TangentCode,
        grid: StepRow,
        constants: Vector,
        passages: ReplacedSteps | None = None,
    ) -> None:
        self._code, self._grid, self._constants = code, grid, constants
        e, lanes = code.equations, code.lanes
        n_x = self._n_x = len(e.states)
        n_z = self._n_z = len(e.unknowns)
        n_values, n_c = code.n_values, code.n_constants
        self._n_a = len(code.stage.accelerated)
        one, before = code.stage.n_weights - 1, 1 + n_x
        of_c = range(before + n_z, before + n_z + n_c)
        back = code.stage.program.transposed(of_c, one), range(n_z + n_x)
        ends = code.seen.joined(before, n_z).transposed([*range(1, before), *of_c], one)
        behind = range(n_z, n_z + n_values)
        self._sums = BackSums.of(code.call, *back, lanes)
        self._ends = BackSums.of(code.call, ends, behind, lanes)
        nothing = passes(code.call, code.stage.program, np.zeros((1, 0)))
        known, solution = code.to_rates, code.stage.solution
        self._map = SlopeMap.of(n_z + n_x, known, nothing, lanes, solution)
        self._numbers, self._bundle = code.numbers(), Bundle(code, np.zeros((n_c, 0)))
        self._steps = steps_of(grid)
        self.adjoint = np.zeros(n_x)
        self._passages, self._passed = passages, dict[int, ReplacedStep]()
        self.passages_adjoint = np.zeros(len(e.parameters))

    @property
    def constants_adjoint(self) -> Vector:
        """Derivatives by the constants that have added up, shape (n_constants,)."""
        return self._sums.total() + self._ends.total()[self._n_x :]

    def record(self, n_intervals: int, start: tuple[Vector, Vector]) -> Record:
        """Return a motion to go back over."""
        per = self._grid.per_interval
        n_steps, width = n_intervals * per, 8 * (self._n_x + self._n_z)
        of_stage = width + 8 * self._n_a
        kept = n_steps * _STAGES * of_stage <= _MOST_BYTES
        each = n_steps if kept else max(1, ceil(sqrt(n_steps)))
        n_kept = -(-n_steps // each)
        states, unknowns = np.empty((n_kept, self._n_x)), np.empty((n_kept, self._n_z))
        at = np.empty((n_intervals + 1, self._n_x)), np.empty((n_intervals + 1, self._n_z))
        state, guess = (np.array(item, dtype=float) for item in start)
        room = self._stage_room(each)
        for k in range(n_kept):
            first, count = k * each, min(each, n_steps - k * each)
            states[k], unknowns[k] = state, guess
            self._follow(first, count, (state, guess), room)
            begins = np.arange(-(-first // per), -(-(first + count) // per))
            for samples, found in zip(at, room[:2], strict=True):
                samples[begins] = found[(begins * per - first) * _STAGES]
        at[0][-1], at[1][-1] = state, guess
        times = self._grid.start + self._grid.interval * np.arange(n_intervals + 1, dtype=float)
        n_bytes = of_stage * each * _STAGES + (0 if kept else width * n_kept)
        stages = room if kept else None
        return Record(
            n_steps, each, states, unknowns, stages, Samples(times, *at, np.zeros(0)), n_bytes
        )

    def _stage_room(self, count: int) -> _Stages:
        x, z, a = (np.empty((count * _STAGES, n)) for n in (self._n_x, self._n_z, self._n_a))
        return x, z, a

    def _stages(self, record: Record, block: int, count: int) -> _Stages:
        """Return the stages of a block, computed again if not kept."""
        if record.stages is not None:
            return record.stages
        room = self._stage_room(count)
        start = record.states[block].copy(), record.unknowns[block].copy()
        self._follow(block * record.stride, count, start, room)
        return room

    def back(self, record: Record, seeds: Vector) -> None:
        """Carry the adjoint from the end to the start.

        ``seeds`` (n_intervals + 1, n_states) are added at the begin of each interval on the way.
        """
        for block in range(len(record.states) - 1, -1, -1):
            first = block * record.stride
            count = min(record.stride, record.n_steps - first)
            stages = self._stages(record, block, count)
            for begin, end in reversed(self._spans(first, count)):
                if begin == end:
                    self._pass_back(begin, seeds)
                    continue
                status = self._code.call(
                    "vd_steps_back",
                    self._steps,
                    begin,
                    end - begin,
                    self._numbers.of(self._constants),
                    *_rows(stages, begin - first, end - first),
                    self._map.slopes,
                    self._sums.back,
                    seeds,
                    self.adjoint,
                )
                self._code.check(status, self._time(begin))

    def _pass_back(self, step: int, seeds: Vector) -> None:
        passage, per = self._passed[step], self._grid.per_interval
        self.passages_adjoint += passage.by_parameter.T @ self.adjoint
        self.adjoint[:] = passage.by_state.T @ self.adjoint
        if step % per == 0:
            self.adjoint += seeds[step // per]

    def _spans(self, first: int, count: int) -> list[tuple[int, int]]:
        """Return spans of whole steps, and empty ones where a passage is, in their order."""
        found, begin, end = [], first, first + count
        for step in sorted(self._passages.steps) if self._passages else ():
            if first <= step < end:
                found += [(begin, step)] * (step > begin) + [(step, step)]
                begin = step + 1
        return [*found, *[(begin, end)] * (end > begin)]

    def _follow(self, first: int, count: int, point: tuple[Vector, ...], room: _Stages) -> None:
        """Take steps and note their stages; of a passage only where it begins."""
        for begin, end in self._spans(first, count):
            rows = _rows(room, begin - first, max(end, begin + 1) - first)
            if end > begin:
                self._take(begin, end - begin, point, rows)
                continue
            rows[0][0], rows[1][0] = point
            if begin not in self._passed and self._passages:
                self._passed[begin] = self._passages.taken(begin, *point)
            passage = self._passed[begin]
            point[0][:], point[1][:] = passage.state, passage.unknowns

    def seeded(self, samples: Samples, seeds: Vector) -> Vector:
        """Return what seeds (n, n_values) of observed values do by the states there."""
        found = np.zeros((len(samples.times), self._n_x))
        arrays = [np.ascontiguousarray(item, dtype=float) for item in samples[:3]]
        status = self._code.call(
            "vd_values_back",
            len(found),
            *arrays,
            self._numbers.of(self._constants),
            self._ends.back,
            self._ends.number,
            np.ascontiguousarray(seeds, dtype=float),
            found,
        )
        self._code.check(status, float(samples.times[0]))
        return found

    def values(self, samples: Samples) -> Vector:
        """Return what is observed at points, shape (n, n_values)."""
        return self._bundle.found(samples, self._constants).values

    def _take(self, first: int, count: int, point: tuple[Vector, ...], room: _Stages) -> None:
        status = self._code.call(
            "vd_record", self._steps, first, count, self._constants, *point, *room
        )
        self._code.check(status, self._time(first))

    def _time(self, step: int) -> float:
        whole, rest = divmod(step, self._grid.per_interval)
        return self._grid.start + self._grid.interval * (whole + rest / self._grid.per_interval)


def _rows(stages: _Stages, begin: int, end: int) -> _Stages:
    """Return those of some steps."""
    x, z, a = (item[begin * _STAGES : end * _STAGES] for item in stages)
    return x, z, a
