"""Floquet multipliers of an orbit: how small disturbances change in one period."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vehicledyn.solve.engine import Vector
from vehicledyn.solve.periodic.autonomous import AutonomousField
from vehicledyn.solve.periodic.collocation import Condensed

STABLE = 1.0 + 1e-6
"""Largest magnitude of a multiplier that counts as stable."""

_CORRECTIONS = 4


@dataclass(frozen=True)
class Multipliers:
    """All multipliers (n_kept,) and the trivial one, which belongs to a shift along the orbit.

    The trivial one is 1 on the exact orbit; its distance from 1 tells how good the mesh is.
    ``others`` (n_kept - 1,) are those of disturbances across the motion.
    """

    others: Vector
    trivial: float

    @property
    def all(self) -> Vector:
        """The trivial multiplier and the others."""
        return np.concatenate([[self.trivial], self.others])

    @property
    def unstable(self) -> int:
        """Number of disturbances that grow."""
        return int((np.abs(self.others) > STABLE).sum())

    @property
    def test_branch(self) -> float:
        """Π (μ - 1): zero at folds and branch points."""
        return float(np.prod(self.others - 1.0).real)

    @property
    def test_doubling(self) -> float:
        """Π (μ + 1): zero where the period doubles."""
        return float(np.prod(self.others + 1.0).real)

    @property
    def turning(self) -> int:
        """Number of complex multipliers outside the unit circle."""
        outside = np.abs(self.others) > STABLE
        return int((outside & (np.abs(self.others.imag) > 1e-7)).sum())


def multipliers_of(field: AutonomousField, system: Condensed) -> Multipliers:
    """Return the multipliers of an orbit that has been found.

    The product of the maps between mesh points is the monodromy matrix M. In coordinates with
    the velocity v first, M v = v makes its first column trivial; the rest holds the others,
    which thus stay accurate where one of them comes near 1 (a fold).
    """
    product = np.eye(system.size)
    for transfer in system.transfers:
        product = transfer @ product
    first = _start_velocity(field, system)
    complete = np.linalg.qr(np.column_stack([first, np.eye(system.size)]))[0]
    turned = complete.T @ product @ complete
    others = np.linalg.eigvals(turned[1:, 1:])
    order = np.argsort(-np.abs(others), kind="stable")
    return Multipliers(others[order].astype(complex), float(turned[0, 0]))


def _start_velocity(field: AutonomousField, system: Condensed) -> Vector:
    """Return the unit direction of the motion at the first mesh point, scaled."""
    orbit = system.orbit
    _, unknowns = orbit.sample(np.array([0.0]))
    for _ in range(_CORRECTIONS):
        found = field.evaluate(orbit.states[:1], unknowns, orbit.parameter)
        unknowns = unknowns - found.gap
    velocity = found.rates[0] / system.scales.states
    return np.asarray(velocity / np.linalg.norm(velocity))
