"""Segments of a track as a file lists them: straights, arcs, and transitions between these."""

from __future__ import annotations

from typing import ClassVar

from vehicledyn.base.parameters import ParameterSet, quantity
from vehicledyn.base.registry import register


class SegmentSet(ParameterSet):
    """Base of the segments.

    ``shape`` is how a transition changes, empty for segments of constant curvature.
    """

    shape: ClassVar[str] = ""

    length: float = quantity("m", "Length of the segment seen from above", gt=0.0, lt=1e6)

    @property
    def constant(self) -> tuple[float, float, float] | None:
        """Curvature [1/m], cant [m] and widening [m], None for a transition."""
        return None


class _Constant(SegmentSet):
    cant: float = quantity("m", "Height of the right rail over the left one", default=0.0)
    widening: float = quantity("m", "Widening of the gauge, by the inner rail", default=0.0)

    @property
    def curvature(self) -> float:
        """Curvature, positive to the left [1/m]."""
        return 0.0

    @property
    def constant(self) -> tuple[float, float, float]:
        """Curvature [1/m], cant [m] and widening [m]."""
        return self.curvature, self.cant, self.widening


@register("segment", "straight")
class Straight(_Constant):
    """Straight track; of a widening either rail takes half."""


@register("segment", "arc")
class ArcSegment(_Constant):
    """A circular arc."""

    radius: float = quantity("m", "Radius, positive to the left")

    @property
    def curvature(self) -> float:
        """Curvature, positive to the left [1/m]; infinite for a radius of zero."""
        return 1.0 / self.radius if self.radius != 0.0 else float("inf")


@register("segment", "clothoid")
class Clothoid(SegmentSet):
    """A transition whose curvature and cant change evenly."""

    shape: ClassVar[str] = "linear"


@register("segment", "bloss")
class Bloss(SegmentSet):
    """A transition along 3 u² - 2 u³, after Bloss."""

    shape: ClassVar[str] = "bloss"


@register("segment", "cosine")
class Cosine(SegmentSet):
    """A transition along half a cosine wave, (1 - cos π u) / 2."""

    shape: ClassVar[str] = "cosine"


@register("segment", "klein")
class Klein(SegmentSet):
    """A transition along u - sin(2 π u) / (2 π), after Klein."""

    shape: ClassVar[str] = "klein"


@register("segment", "cubic_parabola")
class CubicParabola(SegmentSet):
    """A transition of plan y = x³ / (6 R X) from a straight to an arc or back; cant evenly.

    X is the abscissa of the end towards the arc of radius R. There the curvature falls short of
    that of the arc by the factor (1 + X²/(4 R²))^(-3/2), a small jump that practice accepts.
    """

    shape: ClassVar[str] = "cubic_parabola"


@register("segment", "ramp")
class Ramp(SegmentSet):
    """Cant and widening change evenly; the curvature is that of the straighter neighbour."""

    shape: ClassVar[str] = "linear"
