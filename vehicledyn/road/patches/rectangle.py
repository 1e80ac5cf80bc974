"""A rectangle along the axes of the world, open to the sides that are not given."""

from __future__ import annotations

from functools import reduce

from pydantic import model_validator

from vehicledyn.base.parameters import quantity
from vehicledyn.base.registry import register
from vehicledyn.road.patches.patch import FrictionPatch
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


@register("patch", "rectangle")
class Rectangle(FrictionPatch):
    """Rectangle of other friction: an icy side of the road, a wet stretch, a plate."""

    start: float | None = quantity("m", "World x where it begins", default=None)
    end: float | None = quantity("m", "World x where it ends", default=None)
    right: float | None = quantity("m", "World y of its right border", default=None)
    left: float | None = quantity("m", "World y of its left border", default=None)

    @model_validator(mode="after")
    def _check(self) -> Rectangle:
        """Refuse rectangles without a border and those turned round."""
        if all(side is None for side in (self.start, self.end, self.right, self.left)):
            raise ValueError("needs a border at least: start, end, right or left")
        for low, high in (("start", "end"), ("right", "left")):
            first, last = getattr(self, low), getattr(self, high)
            if first is not None and last is not None and not first < last:
                raise ValueError(f"{high}: must be larger than {low}")
        return self

    def depth(self, x: Scalar, y: Scalar) -> Scalar:
        """Return the distance to the nearest border, negative outside [m]."""
        found: list[Scalar] = []
        if self.start is not None:
            found.append(x - self.start)
        if self.end is not None:
            found.append(self.end - x)
        if self.right is not None:
            found.append(y - self.right)
        if self.left is not None:
            found.append(self.left - y)
        return reduce(ops.minimum, found)
