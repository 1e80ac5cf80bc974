"""Plates of other friction in turn, as on the chessboard track of a proving ground."""

from __future__ import annotations

import math

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.patches.patch import FrictionPatch
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


@register("patch", "chequers")
class Chequers(FrictionPatch):
    """Square plates of other friction, every second one, over all of the ground."""

    side: float = quantity("m", "Side of a plate", gt=0)

    def depth(self, x: Scalar, y: Scalar) -> Scalar:
        """Return the distance to the nearest border of a plate, negative beside plates [m]."""
        along, across = self._wave(x), self._wave(y)
        same = along * across > 0.0
        nearest = ops.minimum(ops.absolute(along), ops.absolute(across))
        return ops.where(same, nearest, -nearest)

    def _wave(self, place: Scalar) -> Scalar:
        """Return the distance to the nearest border, negative in every second stripe [m]."""
        return ops.asin(ops.sin(place * (math.pi / self.side))) * (self.side / math.pi)
