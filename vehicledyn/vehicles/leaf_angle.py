"""The angle of the Iltis's leaf spring, a coordinate of the benchmark that our tree lacks."""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.multibody.elements.point_forces import Attachment
from vehicledyn.multibody.model.parts import BasePart, Output, Situation
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel


@dataclass(frozen=True)
class LeafAngle(BasePart):
    """Rotation about the chassis x axis of a leaf that points to the side when it is zero."""

    inner: Attachment
    outer: Attachment
    is_left: bool

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the angle of the leaf."""
        pair = situation.kinematics.between(self.inner.body, self.outer.body)
        reach = pair.rotation(self.inner.body).T @ (
            pair.position(self.outer.body, self.outer.point)
            - pair.position(self.inner.body, self.inner.point)
        )
        side = 1.0 if self.is_left else -1.0
        angle = ops.atan2(side * reach[2], side * reach[1])
        text = "Rotation of the leaf about x"
        return (Output(Channel(f"{self.name}_angle", "rad", text, self.inner.body), angle),)
