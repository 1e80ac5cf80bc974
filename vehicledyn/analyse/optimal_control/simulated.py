"""Simulate the controls of a trajectory with the model's kernel: an independent check of it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.optimal_control.problem import ControlProblem
from vehicledyn.analyse.optimal_control.trajectory import DEGREE, Trajectory, radau_points
from vehicledyn.base.errors import NumericalError
from vehicledyn.kernel.engine import Ledger
from vehicledyn.kernel.kernel import Kernel

Floats = NDArray[np.float64]


class ControlledRun:
    """Steps of the classical Runge-Kutta method under the controls of a trajectory.

    Parameters
    ----------
    problem
        The problem the trajectory solves.
    kernel
        Of the same equations.
    trajectory
        The motion with its controls.
    step
        Largest step [s].
    """

    def __init__(
        self, problem: ControlProblem, kernel: Kernel, trajectory: Trajectory, step: float
    ) -> None:
        self._problem, self._trajectory, self._step = problem, trajectory, step
        self._kernel = kernel.with_parameters(problem.parameters)

    def free(self) -> Floats:
        """Return the states of a run from the start, at all collocation points.

        Shape (1 + n DEGREE, n_x); not a number from where the run fails.
        """
        found = np.full((1 + self._trajectory.n_intervals * DEGREE, self._size), np.nan)
        found[0] = state = self._trajectory.first.copy()
        unknowns = self._trajectory.unknowns[0, 0].copy()
        try:
            for k in range(self._trajectory.n_intervals):
                for j, (states, unknowns) in enumerate(self._interval(k, state, unknowns)):
                    found[1 + k * DEGREE + j] = state = states
        except NumericalError:
            pass
        return found

    def defects(self) -> Floats:
        """Return by how much runs from the beginning of each interval miss its end, (n, n_x)."""
        nodes, found = self._trajectory.nodes, []
        for k in range(self._trajectory.n_intervals):
            last = nodes[k]
            try:
                for states, _ in self._interval(k, nodes[k], self._trajectory.unknowns[k, 0]):
                    last = states
                found.append(last - nodes[k + 1])
            except NumericalError:
                found.append(np.full(self._size, np.inf))
        return np.array(found)

    @property
    def _size(self) -> int:
        return int(self._trajectory.first.size)

    def _interval(self, k: int, state: Floats, unknowns: Floats):  # type: ignore[no-untyped-def]
        """Yield states and unknowns at the collocation points of an interval."""
        t = self._trajectory
        begin, length = t.duration * t.mesh[k], t.duration * (t.mesh[k + 1] - t.mesh[k])
        x, z, part = state.copy(), unknowns.copy(), 0.0
        for point in radau_points():
            count = max(math.ceil((point - part) * length / self._step), 1)
            size = (point - part) / count
            for _ in range(count):
                x, z = self._advance(k, begin, length, part, size, x, z)
                part += size
            part = float(point)
            yield x, z

    def _advance(self, k, begin, length, part, size, x, z):  # type: ignore[no-untyped-def]
        h = size * length
        a, z = self._rates(k, begin, length, part, x, z)
        b, z = self._rates(k, begin, length, part + 0.5 * size, x + 0.5 * h * a, z)
        c, z = self._rates(k, begin, length, part + 0.5 * size, x + 0.5 * h * b, z)
        d, z = self._rates(k, begin, length, part + size, x + h * c, z)
        following = x + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
        if not np.isfinite(following).all():
            raise NumericalError("the run left the finite numbers")
        return following, z

    def _rates(self, k, begin, length, part, x, z):  # type: ignore[no-untyped-def]
        values = self._trajectory.control(self._problem.controls, k, part)
        numbers = self._problem.parameters.copy()
        for j, control in enumerate(self._problem.controls):
            for index, order, factor in control.entries:
                numbers[index] += factor * values[order, j]
        self._kernel.set_parameters(numbers)
        z = z.copy()
        return self._kernel.evaluate(begin + part * length, x, z, Ledger()), z


def relative_errors(states: Floats, others: Floats, units: list[str]) -> Floats:
    """Return the largest difference of each state over its range, shape (n_x,).

    A range is at least a thousandth of the largest one of the same unit, so that what hardly moves
    is not measured by itself.
    """
    ranges = np.ptp(states, axis=0)
    largest = {unit: max(r for r, u in zip(ranges, units, strict=True) if u == unit) for unit in units}
    floor = np.array([1e-3 * largest[unit] for unit in units])
    missed = np.abs(others - states).max(axis=0)
    return np.where(missed == 0.0, 0.0, missed / np.maximum(np.maximum(ranges, floor), 1e-300))
