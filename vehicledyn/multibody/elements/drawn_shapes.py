"""Shapes that a user gives to bodies: they are drawn, and act on nothing."""

from __future__ import annotations

from dataclasses import dataclass, field

from vehicledyn.base.shapes import Shape
from vehicledyn.multibody.model.parts import BasePart


@dataclass(frozen=True)
class DrawnShapes(BasePart):
    """The look of some bodies, which with their joints are not drawn otherwise."""

    name: str = "drawn shapes"
    given: tuple[Shape, ...] = field(default=())
    bodies: frozenset[str] = frozenset()

    def shapes(self) -> tuple[Shape, ...]:
        """Return the shapes."""
        return self.given
