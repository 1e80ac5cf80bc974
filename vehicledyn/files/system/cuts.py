"""Cuts of system files: where loops are opened."""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any

from pydantic import Field

from vehicledyn import multibody
from vehicledyn.base.registry import register
from vehicledyn.files.expressions.fields import Scalar, SystemSet, measured
from vehicledyn.files.system.laws import Values
from vehicledyn.files.system.places import Place

if TYPE_CHECKING:
    from vehicledyn.multibody.model.cuts import Cut


class CutSet(SystemSet):
    """Base of the cuts: two places that a loop brings together again."""

    a: Place = Field(description="Place on the first body")
    b: Place = Field(description="Place on the second body")

    @abstractmethod
    def cut(self, name: str, value: Values) -> Cut:
        """Return the cut of this name."""

    def ends(self, value: Values) -> tuple[str, Any, str, Any]:
        """Return first body and point, second body and point."""
        return self.a.body, value(self.a.point), self.b.body, value(self.b.point)


@register("cut", "ball")
class BallCutSet(CutSet):
    """A ball joint: the two places coincide."""

    def cut(self, name: str, value: Values) -> Cut:
        """Return the cut."""
        return multibody.BallCut(name, *self.ends(value))


@register("cut", "rod")
class RodCutSet(CutSet):
    """A massless rod with a ball joint at each end: the places keep their distance."""

    length: Scalar = measured("m", "Length of the rod", above=0.0)

    def cut(self, name: str, value: Values) -> Cut:
        """Return the cut."""
        return multibody.RodCut(name, *self.ends(value), value(self.length))


@register("cut", "body")
class BodyCutSet(CutSet):
    """A body cut in two: the places coincide and the axes of both bodies are parallel."""

    def cut(self, name: str, value: Values) -> Cut:
        """Return the cut."""
        return multibody.BodyCut(name, *self.ends(value))
