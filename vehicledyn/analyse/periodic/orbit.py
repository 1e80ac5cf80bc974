"""A periodic orbit as polynomials on a mesh, and how it is moved to another mesh."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from vehicledyn.analyse.periodic.basis import Basis
from vehicledyn.kernel.engine import Vector

_SMOOTHING = 0.2
"""Part of the mean monitor that every interval gets."""

_ON_KINK = 1e-6
"""Distance of a mesh point from a kink whose jump of derivatives is no error."""

_SMALL = 1e-3
_OF_MEAN = 0.1
"""Least scale of a state, part of the largest range of all."""


@dataclass(frozen=True)
class Orbit:
    """Period [s] and parameter, mesh (n + 1,) from 0 to 1, and the motion on it.

    ``states`` (n * degree, n_kept) at the representation points of all intervals, the last one
    of which is the first again; ``unknowns`` (n * degree, n_unknowns) at the Gauss points.
    """

    basis: Basis
    mesh: Vector
    states: Vector
    unknowns: Vector
    period: float
    parameter: float

    @property
    def intervals(self) -> int:
        """Number of mesh intervals."""
        return len(self.mesh) - 1

    @property
    def widths(self) -> Vector:
        """Parts of the period that the intervals take."""
        return np.asarray(np.diff(self.mesh))

    def pieces(self, states: Vector | None = None) -> Vector:
        """Return the states of each interval, shape (n, degree + 1, n_kept)."""
        given = self.states if states is None else states
        closed = np.concatenate([given, given[:1]])
        m = self.basis.degree
        return np.asarray(closed[np.arange(self.intervals)[:, None] * m + np.arange(m + 1)])

    def at_gauss(self, states: Vector | None = None) -> Vector:
        """Return the states at the Gauss points, shape (n, degree, n_kept)."""
        return np.asarray(np.einsum("ki,jis->jks", self.basis.value, self.pieces(states)))

    def slopes(self, states: Vector | None = None) -> Vector:
        """Return the derivatives by the part of the interval at the Gauss points."""
        return np.asarray(np.einsum("ki,jis->jks", self.basis.slope, self.pieces(states)))

    def scales(self) -> Vector:
        """Return a size for each state: its range, at least a small part of the largest.

        A state that hardly oscillates, as the rate of a wheel that rolls, may still change along
        a branch: its size is at least a part of its mean.
        """
        ranges = np.ptp(self.states, axis=0)
        least = max(_SMALL * float(ranges.max()), np.finfo(float).tiny)
        means = _OF_MEAN * np.abs(self.states.mean(axis=0))
        return np.asarray(np.maximum(np.maximum(ranges, means), least))

    def sample(self, places: Vector) -> tuple[Vector, Vector]:
        """Return states and (interpolated) unknowns at places, parts of the period."""
        j = np.clip(np.searchsorted(self.mesh, places, side="right") - 1, 0, self.intervals - 1)
        part = (places - self.mesh[j]) / self.widths[j]
        m = self.basis.degree
        states = np.einsum("qi,qis->qs", self.basis.values_at(part), self.pieces()[j])
        if not self.unknowns.size:
            return states, np.zeros((len(places), 0))
        unknowns = self.unknowns.reshape(self.intervals, m, -1)
        others = np.einsum("qk,qkz->qz", self.basis.gauss_values_at(part), unknowns[j])
        return states, others

    def times_of(self, mesh: Vector) -> tuple[Vector, Vector]:
        """Return representation and Gauss points of a mesh, parts of the period."""
        m, widths = self.basis.degree, np.diff(mesh)
        own = mesh[:-1, None] + widths[:, None] * np.arange(m) / m
        return own.ravel(), (mesh[:-1, None] + widths[:, None] * self.basis.points).ravel()

    def moved(self, mesh: Vector) -> Orbit:
        """Return the orbit on another mesh, interpolated."""
        own, gauss = self.times_of(mesh)
        return replace(self, mesh=mesh, states=self.sample(own)[0], unknowns=self.sample(gauss)[1])


def adapted_mesh(
    orbit: Orbit, scales: Vector, intervals: int, kinks: Vector | None = None
) -> Vector:
    """Return the mesh on which the error of collocation is spread evenly.

    The (m + 1)-th derivative comes from differences of the m-th one, which is constant in each
    interval. At a bend of the motion it grows as the mesh gets finer, which gathers points;
    jumps at mesh points that lie on ``kinks`` (parts of the period) are no error.

    References
    ----------
    de Boor (1973), Good approximation by splines with variable knots; Russell, Christiansen
    (1978), SIAM J. Numer. Anal. 15(1).
    """
    m, widths = orbit.basis.degree, orbit.widths
    highest = np.einsum("i,jis->js", orbit.basis.highest, orbit.pieces() / scales)
    highest /= widths[:, None] ** m
    distances = 0.5 * (widths + np.roll(widths, 1))
    jumps = np.abs(highest - np.roll(highest, 1, axis=0)) / distances[:, None]
    if kinks is not None and kinks.size:
        near = np.abs(orbit.mesh[:-1, None] - kinks[None, :]).min(axis=1) < _ON_KINK
        jumps[near] = np.nan
    sides = np.stack([jumps, np.roll(jumps, -1, axis=0)])
    known = np.isfinite(sides)
    error = (np.where(known, sides, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)).max(axis=1)
    monitor = error ** (1.0 / (m + 1))
    monitor = (np.roll(monitor, 1) + 2.0 * monitor + np.roll(monitor, -1)) / 4.0
    mean = float(monitor @ widths)
    if not mean > 0.0:
        return np.linspace(0.0, 1.0, intervals + 1)
    total = np.concatenate([[0.0], np.cumsum((monitor + _SMOOTHING * mean) * widths)])
    mesh = np.interp(np.linspace(0.0, total[-1], intervals + 1), total, orbit.mesh)
    mesh[0], mesh[-1] = 0.0, 1.0
    return np.asarray(mesh)
