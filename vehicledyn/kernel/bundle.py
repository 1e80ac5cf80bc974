"""Directions of a motion carried side by side: tangents of its states, by lanes."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from vehicledyn.base.errors import InputError
from vehicledyn.codegen.passes.linear_program import LinearProgram
from vehicledyn.codegen.passes.stage_program import NO_STEPS, StageSolution
from vehicledyn.kernel.engine import Sides, Status, Vector
from vehicledyn.kernel.plans import Passes, SlopeMap, aligned
from vehicledyn.kernel.tangent_code import MotionPoint, StepRow, StepSpan, TangentCode, steps_of

Array = NDArray[np.float64]

_P = ctypes.c_void_p


class _Directions(ctypes.Structure):
    _fields_ = [
        *[(name, ctypes.c_longlong) for name in ("n", "n_live", "halved")],
        *[(name, _P) for name in ("x", "from_", "to", "room", "moved")],
    ]


class Samples(NamedTuple):
    """Points of a motion: times (n,) [s], states, unknowns, tangents of the states by lanes."""

    times: Vector
    states: Array
    unknowns: Array
    tangents: Array


@dataclass(frozen=True)
class BundleResult:
    """What is found at n points: observed values, and tangents of unknowns and values.

    Tangents have the shape (n, ..., n_directions).
    """

    values: Array
    unknown_slopes: Array
    value_slopes: Array


class _Map(NamedTuple):
    """The derivatives of some results, with the directions that they are wanted by."""

    slopes: SlopeMap
    directions: _Directions
    added: Array


_Rows: TypeAlias = tuple[Array, Array, Array, NDArray[np.int64]]
"""Room for states, unknowns and tangents of samples, and for the number of steps taken."""


class Bundle:
    """Directions carried side by side.

    Parameters
    ----------
    code
        The compiled code.
    constants
        Tangents of the constants, shape (n_constants, n_directions).
    n_idle
        Number of the last directions whose tangents are zero in whole steps.
    """

    def __init__(self, code: TangentCode, constants: Array, *, n_idle: int = 0) -> None:
        n_x, lanes = len(code.equations.states), code.lanes
        self._code, self.n_directions = code, constants.shape[1]
        self._n_live = self.n_directions - n_idle
        groups = self._groups = max(1, -(-self.n_directions // lanes))
        self._x = aligned((n_x, groups, lanes))
        self._at = aligned((2, groups, lanes))
        most = max(len(p.targets) for p in (code.stage.program, code.seen))
        self._constants = constants
        self._room = aligned((1 + 2 * n_x + most, groups, lanes))
        self._numbers = code.numbers()

    @cached_property
    def _to_rates(self) -> _Map:
        stage = self._code.stage
        return self._map(stage.program, self._code.to_rates, stage.solution)

    @cached_property
    def _to_seen(self) -> _Map:
        return self._map(self._code.seen, self._code.to_seen, NO_STEPS)

    def _map(self, program: LinearProgram, known: Passes, solution: StageSolution) -> _Map:
        lanes, n_targets = self._code.lanes, len(program.targets)
        active = np.flatnonzero(self._constants.any(axis=0))
        moved = self._code.passes_by(program, self._constants[:, active])
        entries = moved.entries.copy()
        entries[:, 1] = active[entries[:, 1]]
        moved = replace(moved, entries=entries)
        slopes = SlopeMap.of(n_targets, known, moved, lanes, solution)
        added = aligned((lanes, n_targets, self._groups, lanes))
        return _Map(slopes, self._directions(added, self.n_directions), added)

    @cached_property
    def _live(self) -> _Directions:
        """The directions that whole steps carry, which may be none."""
        found = self._directions(self._to_rates.added, self._n_live)
        found.n_live = found.n_live if self._n_live else 0
        return found

    def _directions(self, added: Array, n_live: int) -> _Directions:
        lanes = self._code.lanes
        arrays = (self._x, self._at[0], self._at[1], self._room, added)
        addresses = [item.ctypes.data for item in arrays]
        groups = max(1, -(-n_live // lanes))
        halved = 2 * (groups * lanes - n_live) >= lanes
        return _Directions(self._groups, groups, halved, *addresses)

    @property
    def state(self) -> Array:
        """Tangents of the states, shape (n_states, n_directions)."""
        return self._plain(self._x)

    @state.setter
    def state(self, values: Array) -> None:
        if values.shape != (self._x.shape[0], self.n_directions):
            raise InputError(f"tangents of shape {values.shape} do not fit")
        n_x, groups, lanes = self._x.shape
        self._x.reshape(n_x, groups * lanes)[:, : self.n_directions] = values

    def part(
        self, grid: StepRow, way: StepSpan, moment: MotionPoint, times: tuple[Vector, Vector]
    ) -> None:
        """Take a part of a step, moving the state and unknowns of a moment and the tangents.

        ``times`` are the tangents of its begin and end [s].
        """
        self._enter_times(times)
        status = self._steps(grid, way, moment, self._row)
        self._code.check(status, moment.time)

    def march(
        self,
        grid: StepRow,
        way: StepSpan,
        moment: MotionPoint,
        sides: Sides,
        branches: ctypes.Structure | None = None,
    ) -> tuple[Status, int, Samples]:
        """Take whole steps, moving the state and unknowns of a moment and the tangents.

        Returns how it ended, the number of steps taken, and the points at the ends of intervals. A
        step that fails, or in which an event fires, is not taken; ``sides`` (n_events,) are the
        signs of the functions of events, as in :class:`vehicledyn.kernel.engine.March`. Nor is one
        in which one of ``branches`` changes that is not skipped, where they are given: see
        :class:`vehicledyn.kernel.branch_watch.BranchWatch`.
        """
        zero = np.zeros(self.n_directions)
        self._enter_times((zero, zero))
        self._room.fill(0.0)
        per = grid.per_interval
        rows = self._rows((way.first + way.n_steps) // per - way.first // per)
        status = self._steps(grid, way, moment, rows, (sides, branches))
        taken = int(rows[-1][0])
        ends = np.arange(way.first // per, (way.first + taken) // per) + 1.0
        times = np.asarray(grid.start + grid.interval * ends, dtype=float)
        return Status(status), taken, Samples(times, *[item[: len(ends)] for item in rows[:-1]])

    def _enter_times(self, times: tuple[Vector, Vector]) -> None:
        for room, values in zip(self._at, times, strict=True):
            room.reshape(-1)[: self.n_directions] = values

    def _rows(self, count: int) -> _Rows:
        """Return room for so many samples, and for the number of steps taken."""
        e, taken = self._code.equations, np.zeros(1, np.int64)
        sizes = (count, len(e.states)), (count, len(e.unknowns))
        states, unknowns = (np.empty(size) for size in sizes)
        return states, unknowns, aligned((count, *self._x.shape)), taken

    @cached_property
    def _row(self) -> _Rows:
        return self._rows(1)

    def _steps(
        self,
        grid: StepRow,
        way: StepSpan,
        moment: MotionPoint,
        rows: _Rows,
        watched: tuple[Sides, ctypes.Structure | None] | None = None,
    ) -> int:
        """Take whole steps, if they are watched, or a part of one; return how that ended."""
        directions = self._to_rates.directions if watched is None else self._live
        return self._code.call(
            "vd_tangent_steps",
            steps_of(grid, way.span),
            way.first,
            way.n_steps,
            self._numbers.of(moment.constants),
            moment.state,
            moment.unknowns,
            *(watched or (None, None)),
            self._to_rates.slopes.slopes,
            directions,
            *rows,
        )

    def here(self, moment: MotionPoint, at: Vector | None = None) -> BundleResult:
        """Return what is found at a moment; ``at`` are the tangents of its time [s]."""
        time, state, unknowns, constants = moment
        samples = Samples(np.array([time]), state[None], unknowns[None], self._x[None])
        return self.found(samples, constants, at)

    def found(self, points: Samples, constants: Vector, at: Vector | None = None) -> BundleResult:
        """Return what is found at points; ``at`` are the tangents of their times [s]."""
        values, slopes = self._points(self._to_seen, points, constants, at)
        return BundleResult(values, *np.split(slopes, [len(self._code.equations.unknowns)], axis=1))

    def rate_slopes(self, moment: MotionPoint) -> Array:
        """Return the tangents of the rates at a moment, shape (n_states, n_directions)."""
        time, state, unknowns, constants = moment
        samples = Samples(np.array([time]), state[None], unknowns[None], self._x[None])
        found = self._points(self._to_rates, samples, constants, None)[1][0]
        return np.asarray(found[len(unknowns) :])

    def _points(
        self, wanted: _Map, points: Samples, constants: Vector, at: Vector | None
    ) -> tuple[Array, Array]:
        """Return observed values at points, and the tangents of the results of a map."""
        count, slopes = len(points.times), wanted.slopes
        times = aligned((count, self._groups, self._code.lanes))
        if at is not None:
            times.reshape(count, -1)[:, : self.n_directions] = at
        values = np.empty((count, self._code.n_values))
        found = aligned((count, slopes.n_targets, self._groups, self._code.lanes))
        status = self._code.call(
            "vd_tangent_points",
            count,
            *[np.ascontiguousarray(item, dtype=float) for item in points[:3]],
            self._numbers.of(constants),
            slopes.slopes,
            wanted.directions,
            times,
            points.tangents,
            values,
            found,
        )
        self._code.check(status, float(points.times[0]) if count else 0.0)
        return values, self._plain(found)

    def _plain(self, lanes: Array) -> Array:
        flat = lanes.reshape(*lanes.shape[:-2], lanes.shape[-2] * lanes.shape[-1])
        return flat[..., : self.n_directions].copy()
