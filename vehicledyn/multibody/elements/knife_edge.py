"""Knife edges: a point of a body that does not move in one direction, as a skate's."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from vehicledyn.base.registry import register
from vehicledyn.multibody.model.constraints import BaseConstraint, Movement, RateConstraint
from vehicledyn.multibody.model.cuts import Residual
from vehicledyn.multibody.model.declaration import ORIGIN, body_name, vector
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar


@register("constraint_type", "knife_edge")
@dataclass(frozen=True)
class KnifeEdge(BaseConstraint):
    """A point of a body does not move in one direction of the body, as a skate does."""

    body: str = body_name("The body")
    across: Sequence[Scalar] = vector("1", "Direction without velocity, in the axes of the body")
    point: Sequence[Scalar] = vector("m", "The point in the axes of the body", default=ORIGIN)

    def speeds(self, movement: Movement) -> list[Residual]:
        """Return the velocity of the point across [m/s]."""

        def across(seen: Movement) -> Scalar:
            direction = seen.rotation(self.body) @ ops.vector(*self.across)
            return ops.dot(direction, seen.velocity(self.body, self.point))

        return RateConstraint(self.name, across).speeds(movement)
