"""Transmissions: screw, gears, belts and racks as linear relations of joint coordinates.

The ratio may be a parameter. An angle of assembly other than zero goes into ``offset``.
"""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass

from vehicledyn.base.registry import register
from vehicledyn.multibody.model.constraints import BaseConstraint, Geometry, LinearConstraint
from vehicledyn.multibody.model.cuts import Proportional, Residual
from vehicledyn.multibody.model.declaration import choice, coordinate_name, number
from vehicledyn.symbolic.ops import Scalar

_SLIDES = ("sliding",)
_BOTH_SLIDE = ("sliding", "turning")
_DRIVEN = ("driven",)
_BOTH_TURN = ("driven", "driving")


@dataclass(frozen=True)
class Transmission(BaseConstraint):
    """Base of the transmissions: two coordinates in a constant ratio."""

    @property
    @abstractmethod
    def relation(self) -> LinearConstraint:
        """The linear relation of the two coordinates."""

    def residuals(self, geometry: Geometry) -> list[Residual]:
        """Return what the relation leaves."""
        return self.relation.residuals(geometry)


@register("constraint_type", "screw")
@dataclass(frozen=True)
class LeadScrew(Transmission):
    """A screw: sliding = pitch · turning/(2 π) + offset, of two joints on one axis.

    Samin, Fisette (2003), chapter 4.2.1 (helicoidal joint).
    """

    sliding: str = coordinate_name("Coordinate along the axis")
    turning: str = coordinate_name("Coordinate about the axis")
    pitch: Scalar = number(
        "m", "Advance of one turn; negative for a left-hand thread", turns_with=_BOTH_SLIDE
    )
    offset: Scalar = number(
        "{length}", "Sliding where turning is zero", default=0.0, turns_with=_SLIDES
    )

    @property
    def relation(self) -> LinearConstraint:
        """Sliding less its part of the turn."""
        factor = -self.pitch / (2.0 * math.pi)
        terms = ((self.sliding, 1.0), (self.turning, factor))
        more = (_torque(self.turning, factor),)
        return LinearConstraint(self.name, terms, self.offset, "m", "N", more)


@register("constraint_type", "rack")
@dataclass(frozen=True)
class Rack(Transmission):
    """A rack and pinion, or a rope on a drum: sliding = radius · turning + offset."""

    sliding: str = coordinate_name("Coordinate of the rack")
    turning: str = coordinate_name("Angle of the pinion")
    radius: Scalar = number(
        "m", "Pitch radius; negative if the rack moves the other way", turns_with=_BOTH_SLIDE
    )
    offset: Scalar = number(
        "{length}", "Sliding where turning is zero", default=0.0, turns_with=_SLIDES
    )

    @property
    def relation(self) -> LinearConstraint:
        """Sliding less the arc."""
        terms = ((self.sliding, 1.0), (self.turning, -self.radius))
        more = (_torque(self.turning, -self.radius),)
        return LinearConstraint(self.name, terms, self.offset, "m", "N", more)


@register("constraint_type", "gears")
@dataclass(frozen=True)
class Gears(Transmission):
    """A pair of gears: driven = -ratio · driving + offset.

    Both angles are measured against the carrier of the axles and about parallel axes of the
    same direction. Samin, Fisette (2003), chapter 4.2.4.
    """

    driven: str = coordinate_name("Angle of the driven wheel against the carrier")
    driving: str = coordinate_name("Angle of the driving wheel against the carrier")
    ratio: Scalar = number(
        "1",
        "Teeth of the driving over those of the driven wheel; negative for a ring gear",
        turns_with=_BOTH_TURN,
    )
    offset: Scalar = number(
        "{length}", "Driven where driving is zero", default=0.0, turns_with=_DRIVEN
    )

    @property
    def relation(self) -> LinearConstraint:
        """Driven and its part of driving."""
        terms = ((self.driven, 1.0), (self.driving, self.ratio))
        more = (_torque(self.driving, self.ratio, "driving_torque"),)
        return LinearConstraint(self.name, terms, self.offset, more=more)


@register("constraint_type", "belt")
@dataclass(frozen=True)
class Belt(Transmission):
    """A belt without stretch or slip between two pulleys.

    r_driven φ_driven = ± r_driving φ_driving, the angles against the carrier of the axles.
    Samin, Fisette (2003), chapter 4.2.3.
    """

    driven: str = coordinate_name("Angle of the driven pulley")
    driving: str = coordinate_name("Angle of the driving pulley")
    driven_radius: Scalar = number("m", "Radius of the driven pulley", above=0.0)
    driving_radius: Scalar = number("m", "Radius of the driving pulley", above=0.0)
    crossed: bool = choice("Whether the belt crosses itself", default=False, turns_with=_BOTH_TURN)
    offset: Scalar = number(
        "{length}", "Driven where driving is zero", default=0.0, turns_with=_DRIVEN
    )

    @property
    def relation(self) -> LinearConstraint:
        """Driven and its part of driving; a channel has the difference of the tensions."""
        ratio = self.driving_radius / self.driven_radius
        factor = ratio if self.crossed else -ratio
        tension = Proportional(
            "tension_difference",
            "N",
            1.0 / self.driven_radius,
            f"Tension of the strand that pulls '{self.driven}' forward, less that of the other",
        )
        more = (_torque(self.driving, factor, "driving_torque"), tension)
        terms = ((self.driven, 1.0), (self.driving, factor))
        return LinearConstraint(self.name, terms, self.offset, more=more)


def _torque(name: str, factor: Scalar, channel: str = "torque") -> Proportional:
    text = f"Torque of the transmission on '{name}'"
    return Proportional(channel, "N*m", factor, text)
