"""Adjoints of a motion: one number's derivatives by everything, for the price of a few runs.

The motion is kept at the begins of its steps; of long ones only some are kept, and the others
computed again from these, so that memory stays bounded.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, sqrt

import numpy as np
from numpy.typing import NDArray

from vehicledyn.codegen.passes.linear_program import Program
from vehicledyn.kernel.engine import Vector
from vehicledyn.kernel.tangent_code import Grid, Moment, TangentCode

_MOST_BYTES = 64_000_000
"""Memory for steps that are kept, above which only some are."""


@dataclass(frozen=True)
class Record:
    """A motion on the way back: every ``stride`` steps states and unknowns at the begin of one.

    ``seconds`` are those of the end, ``n_bytes`` what is kept at most.
    """

    n_steps: int
    stride: int
    states: NDArray[np.float64]
    unknowns: NDArray[np.float64]
    n_bytes: int


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
    """

    def __init__(self, code: TangentCode, grid: Grid, constants: Vector) -> None:
        self._code, self._grid, self._constants = code, grid, constants
        e = code.equations
        self._n_x, self._n_z = len(e.states), len(e.unknowns)
        self._n_c = code.n_constants
        stage, ends = code.stage.program, code.observed.program
        self._b, self._own_b = np.zeros(len(stage.out) + 1), np.zeros(len(ends.out) + 1)
        self._t, self._own_t = np.zeros(stage.n_columns), np.zeros(ends.n_columns)
        self._rates = _places(stage, stage.targets)
        self._unknowns = _places(stage, code.stage.unknowns)
        self._ends = _places(ends, ends.targets)
        self._one, self._own = code.weights(), code.observed_weights()
        self._four = np.tile(self._one, 4)
        self.adjoint = np.zeros(self._n_x)

    @property
    def constants_adjoint(self) -> Vector:
        """Derivatives by the constants that have added up, shape (n_constants,)."""
        first, own = 1 + self._n_x, 1 + self._n_x + self._n_z
        return self._t[first : first + self._n_c] + self._own_t[own : own + self._n_c]

    def record(self, n_steps: int, start: tuple[Vector, Vector]) -> tuple[Record, Moment]:
        """Return a motion to go back over, and its end."""
        width = 8 * (self._n_x + self._n_z)
        stride = 1 if n_steps * width <= _MOST_BYTES else max(1, ceil(sqrt(n_steps)))
        n_kept = -(-n_steps // stride)
        states, unknowns = np.empty((n_kept, self._n_x)), np.empty((n_kept, self._n_z))
        state, guess = (np.array(item, dtype=float) for item in start)
        memory = np.zeros(1 + 2 * max(1, self._n_z))
        if stride == 1:
            self._take(0, n_steps, (state, guess, memory), (states, unknowns))
        else:
            room = np.empty((stride, self._n_x)), np.empty((stride, self._n_z))
            for k in range(n_kept):
                states[k], unknowns[k] = state, guess
                count = min(stride, n_steps - k * stride)
                self._take(k * stride, count, (state, guess, memory), room)
        n_bytes = width * (n_kept + (stride if stride > 1 else 0))
        end = Moment(self._time(n_steps), state, guess, self._constants)
        return Record(n_steps, stride, states, unknowns, n_bytes), end

    def points(self, record: Record, first: int, count: int) -> tuple[Vector, Vector]:
        """Return states and unknowns at the begins of some steps, computed again if not kept."""
        if record.stride == 1:
            chosen = slice(first, first + count)
            return record.states[chosen], record.unknowns[chosen]
        block, offset = divmod(first, record.stride)
        room = np.empty((offset + count, self._n_x)), np.empty((offset + count, self._n_z))
        start = record.states[block].copy(), record.unknowns[block].copy()
        memory = np.zeros(1 + 2 * max(1, self._n_z))
        self._take(block * record.stride, offset + count, (*start, memory), room)
        return room[0][offset:].copy(), room[1][offset:].copy()

    def back(self, record: Record, first: int, last: int) -> None:
        """Carry the adjoint from the begin of step ``last`` back to that of step ``first``."""
        while last > first:
            begin = max(first, (last - 1) // record.stride * record.stride)
            if record.stride == 1:
                begin = first
            xs, zs = self.points(record, begin, last - begin)
            status = self._code.call(
                "vd_steps_back",
                begin,
                last - begin,
                self._grid.per_interval,
                self._grid.start,
                self._grid.interval,
                self._constants,
                np.ascontiguousarray(xs),
                np.ascontiguousarray(zs),
                self._four,
                len(self._one),
                self._rates,
                self._b,
                self._t,
                self.adjoint,
            )
            self._code.check(status, self._time(begin))
            last = begin

    def seed(self, moment: Moment, seeds: Vector) -> None:
        """Add to the adjoint what seeds of the observed values at a moment do."""
        status = self._code.call(
            "vd_values_back",
            *moment,
            self._one,
            self._own,
            self._rates,
            self._unknowns,
            self._ends,
            len(seeds),
            np.ascontiguousarray(seeds, dtype=float),
            self._b,
            self._t,
            self._own_b,
            self._own_t,
            self.adjoint,
        )
        self._code.check(status, moment.time)

    def values(self, moment: Moment) -> Vector:
        """Return what is observed at a moment."""
        found = np.zeros(self._code.n_values + 1)
        self._code.call("vd_observe", *moment, found, self._own)
        return found[:-1]

    def _take(
        self, first: int, count: int, point: tuple[Vector, ...], room: tuple[Vector, Vector]
    ) -> None:
        grid = self._grid
        sizes = (first, count, grid.per_interval, grid.start, grid.interval)
        status = self._code.call("vd_record", *sizes, self._constants, *point, *room)
        self._code.check(status, self._time(first))

    def _time(self, step: int) -> float:
        whole, rest = divmod(step, self._grid.per_interval)
        return self._grid.start + self._grid.interval * (whole + rest / self._grid.per_interval)


def _places(program: Program, columns: NDArray[np.int32]) -> NDArray[np.int32]:
    """Return the rows of the transposed program that have these columns."""
    place = {int(column): k for k, column in enumerate(program.out[::-1])}
    return np.array([place[int(column)] for column in columns], dtype=np.int32)
