"""Outlines of wheels and rails as expressions: height, slope and second derivative at a place."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar
from vehicledyn.symbolic.tables import CurveTable


@dataclass(frozen=True)
class OutlinePoint:
    """A place of an outline: z [m], dz/dy [1] and d²z/dy² [1/m]."""

    height: Scalar
    slope: Scalar
    bend: Scalar

    @property
    def convexity(self) -> Scalar:
        """Return the curvature -z''/(1 + z'²)^(3/2), convex positive [1/m]."""
        stretch = 1.0 + self.slope * self.slope
        return -self.bend / (stretch * ops.sqrt(stretch))


class Outline(Protocol):
    """A curve z(y) in the axes of :mod:`vehicledyn.rail.profiles.profile`, y growing outwards.

    For a wheel z is the increase of the rolling radius over that at y = 0; a convex wheel has
    d²z/dy² < 0 as a convex rail has.
    """

    def at(self, place: Scalar) -> OutlinePoint:
        """Return the outline at a lateral place y [m]."""


@dataclass(frozen=True)
class TableOutline:
    """Any profile, by a table of its height over the lateral place."""

    height: CurveTable

    def at(self, place: Scalar) -> OutlinePoint:
        """Return the outline at a lateral place."""
        table = self.height
        return OutlinePoint(table.value(place), table.slope(place), table.curvature(place))
