"""Simulate the controls of a trajectory with the model's kernel: an independent check of it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

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
                points = list(self._interval(k, state, unknowns))
                begin = 1 + k * DEGREE
                found[begin : begin + DEGREE] = [x for x, _ in points]
                state, unknowns = points[-1]
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

    def _interval(
        self, interval: int, state: Floats, unknowns: Floats
    ) -> Iterator[tuple[Floats, Floats]]:
        """Yield states and unknowns at the collocation points of an interval."""
        t = self._trajectory
        length = t.duration * (t.mesh[interval + 1] - t.mesh[interval])
        x, z, before = state.copy(), unknowns.copy(), 0.0
        for point in radau_points():
            count = max(math.ceil((point - before) * length / self._step), 1)
            size = (point - before) / count
            for number in range(count):
                x, z = self._advance((interval, before + number * size), size, x, z)
            before = float(point)
            yield x, z

    def _advance(
        self, place: tuple[int, float], size: float, x: Floats, z: Floats
    ) -> tuple[Floats, Floats]:
        """Return states and unknowns a step later; places are an interval and a part of it."""
        t, (k, part) = self._trajectory, place
        h = size * t.duration * (t.mesh[k + 1] - t.mesh[k])
        a, z = self._rates(place, x, z)
        b, z = self._rates((k, part + 0.5 * size), x + 0.5 * h * a, z)
        c, z = self._rates((k, part + 0.5 * size), x + 0.5 * h * b, z)
        d, z = self._rates((k, part + size), x + h * c, z)
        with np.errstate(over="ignore", invalid="ignore"):
            following = x + h / 6.0 * (a + 2.0 * b + 2.0 * c + d)
        if not np.isfinite(following).all():
            raise NumericalError("the run left the finite numbers")
        return following, z

    def _rates(self, place: tuple[int, float], x: Floats, z: Floats) -> tuple[Floats, Floats]:
        t, (k, part) = self._trajectory, place
        time = t.duration * (t.mesh[k] + part * (t.mesh[k + 1] - t.mesh[k]))
        values = t.control(self._problem.controls, k, part)
        self._kernel.set_parameters(self._problem.parameters_with(values))
        z = z.copy()
        return self._kernel.evaluate(time, x, z, Ledger()), z


def state_ranges(states: Floats, units: Sequence[str]) -> Floats:
    """Return the range of each state of a motion (n_times, n_x), shape (n_x,).

    A range is at least a thousandth of the largest one of the same unit, of rates a thousandth of
    the largest rate, so that what hardly moves is not measured by itself.
    """
    ranges = np.ptp(states, axis=0)
    largest: dict[str, float] = {}
    for unit, value, size in zip(units, ranges, np.abs(states).max(axis=0), strict=True):
        own = size if unit.endswith("/s") else value
        largest[unit] = max(largest.get(unit, 0.0), float(own))
    floor = np.array([1e-3 * largest[unit] for unit in units])
    return np.asarray(np.maximum(np.maximum(ranges, floor), 1e-12))


def relative_errors(states: Floats, others: Floats, units: Sequence[str]) -> Floats:
    """Return the largest difference of each state over its range, shape (n_x,)."""
    missed = np.abs(others - states).max(axis=0, initial=0.0)
    return np.asarray(missed / state_ranges(states, units))
