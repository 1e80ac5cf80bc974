"""How a bent axis shortens, by its slopes at a few places.

A point at ξ is drawn back by u = -1/(2 L) ∫ v_ξ² dξ from 0 to ξ. The squares of the slopes are
known at some places and integrated as the polynomial through them. The places are those of a Gauss
quadrature, of Radau's with a place at the clamped end, where the slope is zero: ∫ u dξ and ∫ ξ u dξ
are exact for polynomials, and with them what axial and centrifugal forces do to bending. In place
of all pairs of shapes there are then as many slopes as shapes, and one or a few more.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from vehicledyn.multibody.bodies.beam_shapes import Shapes, quadrature
from vehicledyn.multibody.model.deformation import Follower
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

Array = NDArray[np.float64]
_FLAT = 1e-9
"""Slope at the start, over the largest, of shapes that are clamped there."""
_ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class Shortening:
    """The shortening by some bending shapes at the places where the mass stands."""

    shapes: Shapes
    at: Array

    @cached_property
    def _nodes(self) -> tuple[Array, bool]:
        """Places of the slopes, and whether the start, which has none, is one more."""
        start, end = (np.abs(self.shapes.values(x, 1)).max() for x in (0.0, 1.0))
        if start > _FLAT * end:
            return quadrature(self.shapes.points)[0], False
        degree = self.shapes.slopes or self.shapes.points - 1
        found = legendre.legroots([0.0] * degree + [1.0, 1.0])
        return 0.5 * (1.0 + np.sort(found.real)[1:]), True

    @cached_property
    def slopes(self) -> Array:
        """φ_k' at the places, shape (places, shapes)."""
        found = self.shapes.at(self._nodes[0], 1)
        kept = np.abs(found) > _ROUNDING * np.abs(found).max()
        return np.asarray(np.where(kept, found, 0.0), dtype=np.float64)

    @cached_property
    def reach(self) -> Array:
        """Integrals up to each mass of the polynomials that are one at a place each."""
        nodes, has_start = self._nodes
        known = np.concatenate([[0.0], nodes]) if has_start else nodes
        through = np.linalg.inv(legendre.legvander(2.0 * known - 1.0, len(known) - 1))
        summed = legendre.legint(through, scl=0.5, lbnd=-1.0)
        found = np.asarray(legendre.legval(2.0 * self.at - 1.0, summed).T, dtype=np.float64)
        return found[:, 1:] if has_start else found

    def metric(self, index: int) -> Array:
        """Return what stands for ∫ φ_i' φ_j' dξ up to a mass, shape (shapes, shapes)."""
        return np.asarray((self.slopes.T * self.reach[index]) @ self.slopes)

    @cached_property
    def by_slopes(self) -> tuple[Shapes, Array]:
        """Shapes whose amplitudes are slopes at some of the places, and T of these amplitudes T q.

        The places are those that tell the shapes apart best.
        """
        from scipy.linalg import qr

        _, _, order = qr(self.slopes.T, mode="economic", pivoting=True)
        turned = self.slopes[np.sort(order[: self.shapes.count])]
        made = self.shapes.coefficients @ np.linalg.inv(turned)
        return replace(self.shapes, coefficients=made), turned

    def followers(
        self, q: Sequence[Scalar], rates: Sequence[Scalar], length: Scalar, spread: Array
    ) -> list[Follower]:
        """Return -σ²/(2 L) of the slopes σ by ξ as amplitudes.

        Parameters
        ----------
        q, rates
            Amplitudes of the shapes and their rates.
        length
            L [m].
        spread
            One for each shape in the row of its own and the column of its coordinate, shape
            (shapes, coordinates).
        """
        found = []
        for row in self.slopes:
            slope, turning = ops.scalar(0.0), ops.scalar(0.0)
            for factor, value, rate in zip(row, q, rates, strict=True):
                if factor:
                    slope, turning = slope + float(factor) * value, turning + float(factor) * rate
            over = slope / length
            found.append(
                Follower(
                    -0.5 * over * slope, -over, row @ spread, -over * turning,
                    -turning * turning / length,
                )
            )  # fmt: skip
        return found


def inertia_products(
    shapes: Sequence[Shapes],
    axes: Sequence[int | None],
    reaches: Sequence[Array],
    points: tuple[Array, Array],
) -> Array:
    """Return the inertia integrals of a beam of unit mass and length.

    Parameters
    ----------
    shapes, axes
        Shapes of each direction, and the axis along which they displace points, if they do.
    reaches
        What the followers of each direction displace the points by, along the first axis.
    points
        Places and weights of the quadrature.
    """
    x, weights = points
    columns = [np.array([np.ones_like(x), x, 0.0 * x, 0.0 * x])]
    for item, axis in zip(shapes, axes, strict=True):
        for values in item.at(x).T:
            columns.append(np.array([values if k == axis else 0.0 * x for k in range(3)]))
    for reach in reaches:
        columns += [np.array([values, 0.0 * x, 0.0 * x]) for values in reach.T]
    functions = np.vstack(columns)
    return np.asarray((functions * weights) @ functions.T)
