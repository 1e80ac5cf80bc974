"""The axis of an unloaded beam that is an arc or a helix: constant curvature and twist.

With the vector K of twist and curvatures over length, in the axes of any section, a section at the
length s is turned by R₀ = exp(K̃ s) and stands at ∫ R₀ e₁ ds:

    R₀ = 1 + sin θ / θ s K̃ + (1 - cos θ) / θ² s² K̃²,    θ = |K| s,
    p₀ = s e₁ + (1 - cos θ) / θ² s² K̃ e₁ + (θ - sin θ) / θ³ s³ K̃² e₁
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

from vehicledyn.multibody.bodies.beam_shapes import quadrature
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

_LEAST = 1e-60
"""Square of a curvature at which the axis is straight, whose root is divided by [1/m²]."""
_POINTS = 8


@dataclass(frozen=True, eq=False)
class CurvedAxis:
    """An arc or helix.

    ``curvature`` is twist over length about x and curvature about y and z [1/m], ``length`` that
    of the arc [m]; places run from 0 to 1 over it.
    """

    curvature: Sequence[Scalar]
    length: Scalar

    @cached_property
    def vector(self) -> Vec:
        """Twist and curvatures [1/m]."""
        return ops.vector(*self.curvature)

    @cached_property
    def _size(self) -> Scalar:
        return ops.sqrt(ops.dot(self.vector, self.vector) + _LEAST)

    def rotation(self, place: Scalar) -> Mat:
        """Return the rotation of a section, from its axes to those of the start."""
        reach = place * self.length
        theta = self._size * reach
        first = ops.sin(theta) / self._size
        second = 2.0 * (ops.sin(0.5 * theta) / self._size) ** 2
        turned = _skew(self.vector)
        return rotations.identity() + first * turned + second * (turned @ turned)

    def position(self, place: Scalar) -> Vec:
        """Return a point of the axis in the axes of the start [m]."""
        reach = place * self.length
        theta = self._size * reach
        second = 2.0 * (ops.sin(0.5 * theta) / self._size) ** 2
        third = (reach - ops.sin(theta) / self._size) / (self._size * self._size)
        along = ops.vector(1.0, 0.0, 0.0)
        across = ops.cross(self.vector, along)
        return reach * along + second * across + third * ops.cross(self.vector, across)

    def between(self, start: float, end: float) -> tuple[Vec, Mat]:
        """Return place and rotation of a section in the axes of one before it."""
        return self.position(end - start), self.rotation(end - start)

    def inertia(
        self, reach: float, mass: Scalar, polar: Scalar
    ) -> tuple[tuple[Scalar, ...], tuple[Scalar, ...]]:
        """Return centre of mass [m] and inertia about it [kg m²] of a uniform piece.

        Parameters
        ----------
        reach
            Its part of the length.
        mass
            Mass of the piece [kg].
        polar
            Inertia of the piece about its axis, were it straight [kg m²].

        Returns
        -------
        tuple
            Centre (x, y, z), and (xx, yy, zz, xy, xz, yz), in the axes of its start.
        """
        nodes, weights = quadrature(_POINTS)
        points = [self.position(reach * float(node)) for node in nodes]
        centre = ops.vector(0.0, 0.0, 0.0)
        for point, weight in zip(points, weights, strict=True):
            centre = centre + float(weight) * point
        total = None
        for node, point, weight in zip(nodes, points, weights, strict=True):
            arm = point - centre
            along = self.rotation(reach * float(node))[:, 0]
            share = mass * float(weight)
            own = share * (ops.dot(arm, arm) * rotations.identity() - arm @ arm.T)
            own = own + polar * float(weight) * (along @ along.T)
            total = own if total is None else total + own
        return tuple(centre[k] for k in range(3)), _entries(total)


def _skew(v: Vec) -> Mat:
    return rotations.matrix([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def _entries(tensor: Mat) -> tuple[Scalar, ...]:
    pairs = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    return tuple(tensor[i, j] for i, j in pairs)
