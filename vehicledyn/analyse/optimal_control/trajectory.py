"""A motion with its controls on a mesh of collocation points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from vehicledyn.analyse.optimal_control.problem import BEND, RAMP, Control

Floats = NDArray[np.float64]

DEGREE = 3
"""Radau points of an interval."""


@lru_cache(maxsize=1)
def radau_points() -> Floats:
    """Return the points of an interval from 0 to 1, without its beginning, shape (DEGREE,)."""
    import casadi

    return np.array(casadi.collocation_points(DEGREE, "radau"))


@dataclass(frozen=True)
class Trajectory:
    """A motion on a mesh.

    ``mesh`` (n + 1,) from 0 to 1 in parts of the ``duration`` [s]; ``first`` (n_x,) the states at
    the start, ``states`` (n, DEGREE, n_x), ``unknowns`` (n, DEGREE, n_z) and ``distance``
    (n, DEGREE) at the collocation points; ``values``, ``rates`` (n + 1, n_u) of the controls at
    the ends of intervals and ``accelerations`` (n, n_u) within; ``inner`` (n, DEGREE, n_u) those of
    controls that are free at the collocation points.
    """

    duration: float
    mesh: Floats
    first: Floats
    states: Floats
    unknowns: Floats
    first_distance: float
    distance: Floats
    values: Floats
    rates: Floats
    accelerations: Floats
    inner: Floats

    @property
    def n_intervals(self) -> int:
        """Number of intervals."""
        return len(self.mesh) - 1

    @property
    def times(self) -> Floats:
        """Times of the start and all collocation points [s], shape (1 + n DEGREE,)."""
        steps = np.diff(self.mesh)
        inner = self.mesh[:-1, None] + steps[:, None] * radau_points()
        return self.duration * np.concatenate([[0.0], inner.ravel()])

    @property
    def all_states(self) -> Floats:
        """States at these times, shape (1 + n DEGREE, n_x)."""
        return np.vstack([self.first, *self.states])

    @property
    def all_distances(self) -> Floats:
        """Distances along the path at these times, shape (1 + n DEGREE,)."""
        return np.concatenate([[self.first_distance], self.distance.ravel()])

    @property
    def nodes(self) -> Floats:
        """States at the ends of the intervals, shape (n + 1, n_x)."""
        return np.vstack([self.first, self.states[:, -1]])

    def control(self, controls: tuple[Control, ...], interval: int, part: float) -> Floats:
        """Return value, rate and acceleration of all controls, shape (3, n_u).

        ``part`` is the place within the interval, from 0 to 1.
        """
        step = self.duration * (self.mesh[interval + 1] - self.mesh[interval])
        since = part * step
        found = np.zeros((3, len(controls)))
        weights = _lagrange(radau_points(), np.array([part]))[0]
        for k, item in enumerate(controls):
            value, after = self.values[interval, k], self.values[interval + 1, k]
            if item.order == RAMP:
                found[:2, k] = value + part * (after - value), (after - value) / step
            elif item.order == BEND:
                v, a = self.rates[interval, k], self.accelerations[interval, k]
                found[:, k] = value + v * since + 0.5 * a * since**2, v + a * since, a
            else:
                found[0, k] = weights @ self.inner[interval, :, k]
        return found

    def refined(self, controls: tuple[Control, ...], counts: NDArray[np.int64]) -> Trajectory:
        """Return the same motion on a mesh whose intervals are cut into ``counts`` (n,) parts."""
        parts = [
            (k, number / count, 1.0 / count)
            for k, count in enumerate(counts.tolist())
            for number in range(count)
        ]
        steps = np.diff(self.mesh)
        mesh = np.array([self.mesh[k] + part * steps[k] for k, part, _ in parts] + [1.0])
        starts = np.concatenate([[self.first_distance], self.distance[:-1, -1]])
        nodes = self.nodes
        states, unknowns, distance, controlled = [], [], [], []
        for k, part, length in parts:
            at = part + length * radau_points()
            whole = _lagrange(np.concatenate([[0.0], radau_points()]), at)
            inner = _lagrange(radau_points(), at)
            states.append(whole @ np.vstack([nodes[k], self.states[k]]))
            unknowns.append(inner @ self.unknowns[k])
            controlled.append(inner @ self.inner[k])
            distance.append(whole @ np.concatenate([[starts[k]], self.distance[k]]))
        ends = [self.control(controls, k, part) for k, part, _ in parts]
        last = [self.values[-1], self.rates[-1]]
        return Trajectory(
            self.duration,
            mesh,
            self.first,
            np.array(states),
            np.array(unknowns),
            self.first_distance,
            np.array(distance),
            np.array([*(c[0] for c in ends), last[0]]),
            np.array([*(c[1] for c in ends), last[1]]),
            np.array([self.accelerations[k] for k, _, _ in parts]),
            np.array(controlled),
        )


def _lagrange(points: Floats, at: Floats) -> Floats:
    """Return what the values at points weigh in those at others, shape (n_at, n_points)."""
    weights = np.ones((len(at), len(points)))
    for j, point in enumerate(points):
        for i, other in enumerate(points):
            if i != j:
                weights[:, j] *= (at - other) / (point - other)
    return weights
