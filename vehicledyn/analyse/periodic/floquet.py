"""Floquet multipliers of an orbit: how small disturbances change in one period."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vehicledyn.analyse.periodic.monodromy import Passages
from vehicledyn.kernel.engine import Vector

STABLE = 1.0 + 1e-6
"""Largest magnitude of a multiplier that counts as stable."""


@dataclass(frozen=True)
class Multipliers:
    """All multipliers (n_kept,) and the trivial one, which belongs to a shift along the orbit.

    The trivial one is 1 on the exact orbit; its distance from 1 says how good they all are.
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


def multipliers_of(found: Passages) -> Multipliers:
    """Return the multipliers of a closed orbit.

    The monodromy matrix M, in coordinates with the velocity v first, has a trivial first column
    as M v = v; the rest holds the others, which thus stay accurate where one of them comes near 1
    (a fold).
    """
    n = len(found.scales)
    complete = np.linalg.qr(np.column_stack([found.first[0], np.eye(n)]))[0]
    turned = complete.T @ found.monodromy @ complete
    others = np.linalg.eigvals(turned[1:, 1:])
    order = np.argsort(-np.abs(others), kind="stable")
    return Multipliers(others[order].astype(complex), float(turned[0, 0]))
