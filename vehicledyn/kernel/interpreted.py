"""The engine that runs CasADi's virtual machine, with the algorithm of loop.c."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from vehicledyn.codegen.passes.kernel_functions import KernelFunctions
from vehicledyn.kernel.chebyshev import chebyshev_weights
from vehicledyn.kernel.engine import (
    Count,
    Figure,
    Ledger,
    March,
    Method,
    SampleRows,
    Span,
    Status,
    Vector,
)
from vehicledyn.kernel.event_signs import fired, note_sides
from vehicledyn.symbolic.equations import Equations

MAX_ITERATIONS = 12
SMALL_STEP, ROUNDING = 1e-8, 1e-13
INSIDE = 1e-8
"""Where a step looks at its ends, as a part of the step; see loop.c."""


class _Point(NamedTuple):
    time: float
    state: Vector
    unknowns: Vector
    constants: Vector


class _Stretch(NamedTuple):
    """Size and times of a step, or of a part of one; first and last lie just inside.

    ``at`` gives the time of a place in it between 0 and 1.
    """

    size: float
    first: float
    middle: float
    last: float
    end: float
    at: Callable[[float], float]

    @staticmethod
    def of(march: March, step: int, part: Span = (0.0, 1.0)) -> _Stretch:
        begin, to = part
        share = to - begin
        return _Stretch(
            march.interval / march.per_interval * share,
            march.time(step, begin + INSIDE * share),
            march.time(step, begin + 0.5 * share),
            march.time(step, to - INSIDE * share),
            march.time(step, to) if to < 1.0 else march.time(step + 1),
            lambda place: march.time(step, begin + place * share),
        )


class BufferedFunction:
    """A CasADi function with dense arguments, called with little overhead."""

    def __init__(self, function: Any) -> None:
        """Make room for arguments and results."""
        self._buffer, self._evaluate = function.buffer()
        n_in, n_out = function.n_in(), function.n_out()
        self._arguments = [np.zeros(max(1, function.nnz_in(k))) for k in range(n_in)]
        self._sizes = [function.nnz_in(k) for k in range(n_in)]
        self._results = [np.zeros(max(1, function.nnz_out(k))) for k in range(n_out)]
        self._shapes = [(function.nnz_out(k), function.size_out(k)) for k in range(n_out)]
        for k, array in enumerate(self._arguments):
            self._buffer.set_arg(k, array.data)
        for k, array in enumerate(self._results):
            self._buffer.set_res(k, array.data)

    def __call__(self, *arguments: float | Vector) -> list[Vector]:
        """Return copies of the results: columns flat, matrices by their shape."""
        for array, size, value in zip(self._arguments, self._sizes, arguments, strict=True):
            array[:size] = value
        self._evaluate()
        return [
            array[:size].copy() if shape[1] == 1 else array[:size].reshape(shape, order="F").copy()
            for array, (size, shape) in zip(self._results, self._shapes, strict=True)
        ]


class InterpretedEngine:
    """CasADi's virtual machine on the same functions that would be compiled."""

    def __init__(self, equations: Equations, functions: KernelFunctions) -> None:
        """Prepare the functions for quick calls."""
        self._equations = equations
        self._spans = [slice(block.start, block.stop) for block in equations.blocks]
        self._positions = list(equations.positions)
        self._velocities = list(equations.velocities)
        self._prepare = BufferedFunction(functions.prepare)
        self._rates = BufferedFunction(functions.rates)
        self._outputs = BufferedFunction(functions.outputs)
        self._blocks = [BufferedFunction(block) for block in functions.blocks]
        self._events = BufferedFunction(functions.events)
        self._resets = BufferedFunction(functions.resets)
        self._steps: dict[int, Callable[[March, _Stretch, Vector], Status]] = {
            Method.RK4: self._step_rk4,
            Method.SYMPLECTIC_EULER: self._step_symplectic,
        }

    def prepare(self, parameters: Vector) -> Vector:
        """Return what depends on the parameters alone."""
        return self._prepare(parameters)[0]

    def rates(self, time: float, state: Vector, unknowns: Vector, constants: Vector) -> Vector:
        """Return the rates of the states."""
        return self._rates(time, state, unknowns, constants)[0]

    def outputs(self, time: float, state: Vector, unknowns: Vector, constants: Vector) -> Vector:
        """Return the named outputs."""
        return self._outputs(time, state, unknowns, constants)[0]

    def block(
        self, index: int, time: float, state: Vector, unknowns: Vector, constants: Vector
    ) -> tuple[Vector, Vector]:
        """Return residual and Jacobian of a block."""
        residual, jacobian = self._blocks[index](time, state, unknowns, constants)
        return residual, jacobian.reshape((residual.size, residual.size), order="F")

    def survey(
        self, times: Vector, states: Vector, unknowns: Vector, constants: Vector
    ) -> tuple[Vector, Vector]:
        """Return largest residual and determinant of each block at some points."""
        found = np.empty((2, len(times), len(self._spans)))
        for row, (time, state, unknown) in enumerate(zip(times, states, unknowns, strict=True)):
            for k in range(len(self._spans)):
                residual, jacobian = self.block(k, float(time), state, unknown, constants)
                found[:, row, k] = np.abs(residual).max(), _determinant(jacobian)
        return found[0], found[1]

    def solve(
        self, time: float, state: Vector, unknowns: Vector, constants: Vector, ledger: Ledger
    ) -> Status:
        """Solve the blocks in order, changing the unknowns in place."""
        point = _Point(time, state, unknowns, constants)
        for k in range(len(self._spans)):
            status = self._newton(k, point, ledger)
            if status is not Status.SOLVED:
                ledger.counts[Count.WHERE] = k
                ledger.figures[Figure.FAILED_RESIDUAL] = self._residual(k, point)
                return status
        return Status.SOLVED

    def advance(self, march: March, n_steps: int, constants: Vector, rows: SampleRows) -> Status:
        """Take steps and write a row for each whole interval."""
        step_once = self._steps.get(march.method, self._step_chebyshev)
        watched = bool(self._equations.events)
        for step in range(march.step, march.step + n_steps):
            held = [march.state.copy(), march.unknowns.copy(), march.memory.copy()]
            status = step_once(march, _Stretch.of(march, step), constants)
            if watched and status is Status.SOLVED:
                status = self._watch(march, march.time(step + 1), constants)
                if status is Status.EVENT:
                    march.state[:], march.unknowns[:], march.memory[:] = held
            if status is Status.SOLVED:
                march.ledger.counts[Count.STEPS] += 1
                if (step + 1) % march.per_interval == 0:
                    status = self._sample(march, march.time(step + 1), constants, rows)
            if status is not Status.SOLVED:
                return status
        return Status.SOLVED

    def advance_part(self, march: March, part: Span, constants: Vector) -> Status:
        """Take a part of one step, moving state and unknowns but neither step nor sides."""
        stretch = _Stretch.of(march, march.step, part)
        held, march.memory = march.memory, np.zeros_like(march.memory)
        step_once = self._steps.get(march.method, self._step_chebyshev)
        status = step_once(march, stretch, constants)
        march.memory = held
        return status

    def events(self, time: float, state: Vector, unknowns: Vector, constants: Vector) -> Vector:
        """Return the functions of the events."""
        return self._events(time, state, unknowns, constants)[0]

    def resets(self, time: float, state: Vector, unknowns: Vector, constants: Vector) -> Vector:
        """Return the new values that events give to states."""
        return self._resets(time, state, unknowns, constants)[0]

    def _watch(self, march: March, time: float, constants: Vector) -> Status:
        values = self.events(time, march.state, march.unknowns, constants)
        if fired(self._equations.events, march.sides, values).any():
            return Status.EVENT
        note_sides(march.sides, values)
        return Status.SOLVED

    def _sample(self, march: March, time: float, constants: Vector, rows: SampleRows) -> Status:
        state, unknowns = march.state, march.unknowns
        counts, figures = march.ledger.counts, march.ledger.figures
        for k, block in enumerate(self._equations.blocks):
            residual = self._residual(k, _Point(time, state, unknowns, constants))
            figures[Figure.LARGEST_RESIDUAL] = max(figures[Figure.LARGEST_RESIDUAL], residual)
            if not residual <= block.tolerance:
                counts[Count.WHERE] = k
                figures[Figure.FAILED_RESIDUAL] = residual
                return Status.INACCURATE
        row = counts[Count.SAMPLES]
        rows.states[row], rows.unknowns[row] = state, unknowns
        rows.outputs[row] = self.outputs(time, state, unknowns, constants)
        counts[Count.SAMPLES] += 1
        return Status.SOLVED

    def _residual(self, index: int, point: _Point) -> float:
        return float(np.abs(self.block(index, *point)[0]).max())

    def _newton(self, index: int, point: _Point, ledger: Ledger) -> Status:
        unknown = point.unknowns[self._spans[index]]
        for _ in range(MAX_ITERATIONS):
            residual, jacobian = self.block(index, *point)
            ledger.counts[Count.ITERATIONS] += 1
            if not (np.isfinite(jacobian).all() and np.isfinite(residual).all()):
                return Status.NOT_CONVERGED
            try:
                step = np.linalg.solve(jacobian, residual)
            except np.linalg.LinAlgError:
                return Status.SINGULAR
            unknown -= step
            if not np.isfinite(unknown).all():
                return Status.NOT_CONVERGED
            if (np.abs(step) <= SMALL_STEP + ROUNDING * np.abs(unknown)).all():
                return Status.SOLVED
        return Status.NOT_CONVERGED

    def _stage(self, point: _Point, ledger: Ledger) -> tuple[Status, Vector]:
        status = _check_finite(point.state, ledger)
        if status is Status.SOLVED:
            status = self.solve(*point, ledger)
        if status is not Status.SOLVED:
            return status, point.state
        ledger.counts[Count.EVALUATIONS] += 1
        return status, self.rates(*point)

    def _step_rk4(self, march: March, stretch: _Stretch, constants: Vector) -> Status:
        """Classical Runge-Kutta step, with the guesses of the unknowns of loop.c."""
        x, z, ledger = march.state, march.unknowns, march.ledger
        h, middle, end = stretch.size, stretch.middle, stretch.end
        before, between = march.memory[1:].reshape(2, z.size)
        known = march.memory[0]
        bend = known * (z - 2.0 * between + before)
        k1 = self.rates(stretch.first, x, z, constants)
        ledger.counts[Count.EVALUATIONS] += 1
        z2 = z + known * 0.5 * (3.0 * z - 4.0 * between + before)
        status, k2 = self._stage(_Point(middle, x + 0.5 * h * k1, z2, constants), ledger)
        if status is not Status.SOLVED:
            return status
        z3 = z2 + bend
        status, k3 = self._stage(_Point(middle, x + 0.5 * h * k2, z3, constants), ledger)
        if status is not Status.SOLVED:
            return status
        z4 = 2.0 * z3 - z
        status, k4 = self._stage(_Point(stretch.last, x + h * k3, z4, constants), ledger)
        if status is not Status.SOLVED:
            return status
        new = x + h / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
        kept = (z, 0.5 * (z2 + z3))
        return self._accept(march, end, (new, z4), constants, kept)

    def _step_symplectic(self, march: March, stretch: _Stretch, constants: Vector) -> Status:
        """Semi-implicit Euler step: positions move with the new velocities."""
        x, z = march.state, march.unknowns
        h = stretch.size
        before = march.memory[1 : 1 + z.size]
        new = x + h * self.rates(stretch.first, x, z, constants)
        march.ledger.counts[Count.EVALUATIONS] += 1
        new[self._positions] = x[self._positions] + h * new[self._velocities]
        guess = 2.0 * z - before if march.memory[0] else z.copy()
        return self._accept(march, stretch.end, (new, guess), constants, (z,))

    def _step_chebyshev(self, march: March, stretch: _Stretch, constants: Vector) -> Status:
        """Stabilised explicit step of second order, see loop.c."""
        x, ledger, h = march.state, march.ledger, stretch.size
        weights = chebyshev_weights(march.method - Method.CHEBYSHEV)
        first = self.rates(stretch.first, x, march.unknowns, constants)
        ledger.counts[Count.EVALUATIONS] += 1
        before, gain = np.zeros_like(x), h * weights.rate[1] * first
        unknowns = march.unknowns.copy()
        for j in range(2, len(weights.place)):
            time = stretch.at(min(weights.place[j - 1], 1.0 - INSIDE))
            status, rate = self._stage(_Point(time, x + gain, unknowns, constants), ledger)
            if status is not Status.SOLVED:
                return status
            moved = h * (weights.rate[j] * rate + weights.first_rate[j] * first)
            kept = weights.last[j] * gain + weights.before[j] * before
            before, gain = gain, kept + moved
        return self._accept(march, stretch.end, (x + gain, unknowns), constants)

    def _accept(
        self,
        march: March,
        end: float,
        result: tuple[Vector, Vector],
        constants: Vector,
        kept: tuple[Vector, ...] = (),
    ) -> Status:
        """Solve the unknowns at the end of a step; ``kept`` is what the next one's guess needs."""
        state, unknowns = result
        status = _check_finite(state, march.ledger)
        if status is Status.SOLVED:
            status = self.solve(end, state, unknowns, constants, march.ledger)
        if status is Status.SOLVED:
            if kept:
                march.memory[0] = 1.0
                march.memory[1 : 1 + len(kept) * unknowns.size] = np.concatenate(kept)
            march.state[:], march.unknowns[:] = state, unknowns
        return status


def _determinant(matrix: Vector) -> float:
    """Return a determinant; small ones without the cost of a call to the library."""
    if len(matrix) == 1:
        return float(matrix[0, 0])
    if len(matrix) == 2:
        return float(matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[1, 0])
    return float(np.linalg.det(matrix))


def _check_finite(state: Vector, ledger: Ledger) -> Status:
    if np.isfinite(state).all():
        return Status.SOLVED
    ledger.counts[Count.WHERE] = int(np.flatnonzero(~np.isfinite(state))[0])
    return Status.NOT_FINITE
