"""The inertia of a link with all that hangs on it: 6 by 6, symmetric, not that of a rigid body."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from vehicledyn.multibody.recursion.body_inertia import BodyInertia
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

UPPER = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


@dataclass(frozen=True)
class ArticulatedInertia:
    """Force and torque about a frame's origin that its acceleration (a, α) needs.

    force = ``linear`` a + ``coupling`` α and torque = ``coupling``ᵀ a + ``angular`` α, all in
    the frame's axes [kg, kg m, kg m²].
    """

    linear: Mat
    coupling: Mat
    angular: Mat

    @classmethod
    def of(cls, body: BodyInertia) -> ArticulatedInertia:
        """Return that of a body on its own."""
        return cls(*body.mass_blocks())

    def __add__(self, other: ArticulatedInertia) -> ArticulatedInertia:
        """Return the inertia of both together."""
        return ArticulatedInertia(
            self.linear + other.linear,
            self.coupling + other.coupling,
            self.angular + other.angular,
        )

    def in_parent(self, turns: Sequence[Mat], arm: Vec) -> ArticulatedInertia:
        """Return it in a parent frame: turned by each rotation, origin displaced by ``arm``.

        Sums run on from their first term, so that all of their products are fused with them.
        """
        linear, near, angular = self.linear, self.coupling, self.angular
        for turn in turns:
            linear, angular = (rotations.congruent(turn, item) for item in (linear, angular))
            near = rotations.similar(turn, near)
        rows = [ops.plus_cross(near[i, :].T, arm, linear[i, :].T) for i in range(3)]
        far = rotations.matrix([[row[j] for j in range(3)] for row in rows])
        gained = [_plus_moment(angular[i, j], arm, near[:, i], j) for i, j in UPPER]
        gained = [
            _plus_moment(entry, arm, far[:, j], i)
            for entry, (i, j) in zip(gained, UPPER, strict=True)
        ]
        return ArticulatedInertia(linear, far, rotations.symmetric(gained[:3], gained[3:]))


def _plus_moment(entry: Scalar, arm: Vec, force: Vec, k: int) -> Scalar:
    """Return a number plus component k of a moment, summed from the number on."""
    i, j = (k + 1) % 3, (k + 2) % 3
    return entry + arm[i] * force[j] - arm[j] * force[i]
