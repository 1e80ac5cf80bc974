"""What a patch of other friction is: its friction, and how far a place lies in it."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

from vehicledyn.base.parameters import ParameterSet, quantity
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


class FrictionPatch(ParameterSet):
    """Ground of other friction; every patch of the catalogue derives from it."""

    friction: float = quantity(
        "1", "Friction over that of the ground around, which is 1", gt=0.0, le=5.0
    )
    edge: float = quantity(
        "m", "Distance over which the friction changes, about a contact length", default=0.1, gt=0
    )

    @abstractmethod
    def depth(self, x: Scalar, y: Scalar) -> Scalar:
        """Return how far a place of the world lies inside, negative outside [m]."""

    def share(self, x: Scalar, y: Scalar) -> Scalar:
        """Return 1 inside, 0 outside; the change is linear and half done at the border."""
        return ops.minimum(ops.maximum(self.depth(x, y) / self.edge + 0.5, 0.0), 1.0)


def friction_at(patches: Sequence[FrictionPatch], x: Scalar, y: Scalar) -> Scalar:
    """Return the friction of the ground at a place of the world, 1 beside all patches [1].

    Where patches overlap, the one named last counts.
    """
    friction: Scalar = 1.0
    for patch in patches:
        friction = friction + (patch.friction - friction) * patch.share(x, y)
    return friction
