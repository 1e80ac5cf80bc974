"""Constraints of system files that are no cuts: transmissions, rolling, edges, expressions."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, Self

from pydantic import Field

from vehicledyn import multibody
from vehicledyn.base.registry import register
from vehicledyn.files.expressions.expressions import origin, zero
from vehicledyn.files.expressions.fields import Scalar, SystemSet, Vector, measured, reference
from vehicledyn.files.system.laws import Values
from vehicledyn.files.system.places import Place
from vehicledyn.symbolic import ops

if TYPE_CHECKING:
    from vehicledyn.multibody.model.constraints import Constraint, Geometry, Movement


class ConstraintSet(SystemSet):
    """Base of the constraints."""

    @property
    def coordinates(self) -> Sequence[str]:
        """Coordinates that the constraint names; all others it finds itself."""
        return ()

    @abstractmethod
    def constraint(self, name: str, value: Values, coordinates: Sequence[str]) -> Constraint:
        """Return the constraint of this name.

        Parameters
        ----------
        name
            Its name.
        value
            Value of an expression.
        coordinates
            All coordinates of the system.
        """

    def mirrored(self, turned: Sequence[bool]) -> Self:
        """Return the mirror image; ``turned`` says which of its coordinates change their sign."""
        return self


class _Transmission(ConstraintSet):
    """Two coordinates in a constant ratio: q_1 = a q_2 + offset."""

    offset: Scalar = measured(
        "{length}", "First coordinate where the second is zero", default=zero()
    )

    @property
    @abstractmethod
    def factor(self) -> str:
        """Name of the field that the ratio is proportional to."""

    def mirrored(self, turned: Sequence[bool]) -> Self:
        """Return the same ratio between coordinates of other signs."""
        update: dict[str, Any] = {}
        if turned[0]:
            update["offset"] = self.offset.negated()
        if turned[0] != turned[1]:
            factor = getattr(self, self.factor)
            update[self.factor] = not factor if isinstance(factor, bool) else factor.negated()
        return self.model_copy(update=update)


@register("constraint", "screw")
class ScrewSet(_Transmission):
    """A screw: sliding = pitch · turning/(2 π) + offset."""

    sliding: str = reference("coordinate", "Coordinate along the axis")
    turning: str = reference("coordinate", "Coordinate about the axis")
    pitch: Scalar = measured("m", "Advance of one turn; negative for a left-hand thread")

    @property
    def factor(self) -> str:
        """Return the pitch."""
        return "pitch"

    @property
    def coordinates(self) -> Sequence[str]:
        """Return both."""
        return (self.sliding, self.turning)

    def constraint(self, name: str, value: Values, coordinates: Sequence[str]) -> Constraint:
        """Return the screw."""
        pitch, offset = value(self.pitch), value(self.offset)
        return multibody.screw(name, self.sliding, self.turning, pitch, offset=offset)


@register("constraint", "rack")
class RackSet(_Transmission):
    """A rack and pinion, or a rope on a drum: sliding = radius · turning + offset."""

    sliding: str = reference("coordinate", "Coordinate of the rack")
    turning: str = reference("coordinate", "Angle of the pinion")
    radius: Scalar = measured("m", "Pitch radius; negative if the rack moves the other way")

    @property
    def factor(self) -> str:
        """Return the radius."""
        return "radius"

    @property
    def coordinates(self) -> Sequence[str]:
        """Return both."""
        return (self.sliding, self.turning)

    def constraint(self, name: str, value: Values, coordinates: Sequence[str]) -> Constraint:
        """Return the rack."""
        radius, offset = value(self.radius), value(self.offset)
        return multibody.rack(name, self.sliding, self.turning, radius, offset=offset)


@register("constraint", "gears")
class GearSet(_Transmission):
    """A pair of gears: driven = -ratio · driving + offset."""

    driven: str = reference("coordinate", "Angle of the driven wheel against the carrier")
    driving: str = reference("coordinate", "Angle of the driving wheel against the carrier")
    ratio: Scalar = measured(
        "1", "Teeth of the driving over those of the driven wheel; negative for a ring gear"
    )

    @property
    def factor(self) -> str:
        """Return the ratio."""
        return "ratio"

    @property
    def coordinates(self) -> Sequence[str]:
        """Return both."""
        return (self.driven, self.driving)

    def constraint(self, name: str, value: Values, coordinates: Sequence[str]) -> Constraint:
        """Return the gears."""
        ratio, offset = value(self.ratio), value(self.offset)
        return multibody.gears(name, self.driven, self.driving, ratio, offset=offset)


@register("constraint", "belt")
class BeltSet(_Transmission):
    """A belt without stretch or slip between two pulleys."""

    driven: str = reference("coordinate", "Angle of the driven pulley")
    driving: str = reference("coordinate", "Angle of the driving pulley")
    driven_radius: Scalar = measured("m", "Radius of the driven pulley", above=0.0)
    driving_radius: Scalar = measured("m", "Radius of the driving pulley", above=0.0)
    crossed: bool = Field(default=False, description="Whether the belt crosses itself")

    @property
    def factor(self) -> str:
        """Return whether it crosses, which is the sign of the ratio."""
        return "crossed"

    @property
    def coordinates(self) -> Sequence[str]:
        """Return both."""
        return (self.driven, self.driving)

    def constraint(self, name: str, value: Values, coordinates: Sequence[str]) -> Constraint:
        """Return the belt."""
        return multibody.belt(
            name,
            self.driven,
            self.driving,
            value(self.driven_radius),
            value(self.driving_radius),
            crossed=self.crossed,
            offset=value(self.offset),
        )


@register("constraint", "rolling_wheel")
class RollingSet(ConstraintSet):
    """A wheel with a sharp or round edge that rolls on the plane z = 0 without slip."""

    body: str = reference("body", "The wheel; it may have spins_about")
    axis: Literal[1, 2, 3] = Field(description="Axis of the wheel in its body")
    radius: Scalar = measured("m", "Radius of the edge, or to the centre of the crown", above=0.0)
    crown: Scalar = measured("m", "Radius of the crown; zero is sharp", default=zero(), least=0.0)
    centre: Vector = measured(
        "m", "Centre of the wheel in the axes of the body", default=origin(), nature="polar"
    )

    def constraint(self, name: str, value: Values, coordinates: Sequence[str]) -> Constraint:
        """Return the rolling wheel."""
        radius, crown, centre = (value(e) for e in (self.radius, self.crown, self.centre))
        return multibody.RollingWheel(name, self.body, self.axis, radius, crown, centre)


@register("constraint", "knife_edge")
class KnifeEdgeSet(ConstraintSet):
    """A point of a body does not move in one direction of the body, as a skate does."""

    body: str = reference("body", "The body")
    point: Vector = measured(
        "m", "The point in the axes of the body", default=origin(), nature="polar"
    )
    across: Vector = measured(
        "1", "Direction without velocity, in the axes of the body", nature="polar"
    )

    def constraint(self, name: str, value: Values, coordinates: Sequence[str]) -> Constraint:
        """Return the constraint of the point's velocity."""
        point, across = value(self.point), ops.vector(*value(self.across))

        def law(movement: Movement) -> Any:
            direction = movement.rotation(self.body) @ across
            return ops.dot(direction, movement.velocity(self.body, point))

        return multibody.RateConstraint(name, law)


class _Written(ConstraintSet):
    """Base of constraints that are written as expressions."""

    points: dict[str, Place] = Field(
        default_factory=dict,
        description="Points by name; the expression has their world position as name.x, name.y "
        "and name.z",
    )


@register("constraint", "expression")
class WrittenConstraint(_Written):
    """Any relation of coordinates, points and time that vanishes: h(q, t) = 0."""

    zero: Scalar = measured("", "The expression that is zero", variables="geometry")

    def constraint(self, name: str, value: Values, coordinates: Sequence[str]) -> Constraint:
        """Return the holonomic constraint."""

        def law(geometry: Geometry) -> Any:
            known = {c: geometry.coordinate(c) for c in coordinates}
            places = {k: _items(geometry.position(p.body, value(p.point))) for k, p in points}
            return value(self.zero, time=geometry.time, **known, **places)

        points = self.points.items()
        return multibody.UserConstraint(name, law)


@register("constraint", "rate_expression")
class WrittenRate(_Written):
    """Any relation that is linear in the rates and vanishes: B(q, t) q' + b(q, t) = 0.

    Velocities of points are name_velocity.x and so on.
    """

    zero: Scalar = measured("", "The expression that is zero", variables="movement")

    def constraint(self, name: str, value: Values, coordinates: Sequence[str]) -> Constraint:
        """Return the non-holonomic constraint."""

        def law(movement: Movement) -> Any:
            known = {c: movement.coordinate(c) for c in coordinates}
            known |= {f"{c}_rate": movement.rate(c) for c in coordinates}
            for key, place in self.points.items():
                point = value(place.point)
                known[key] = _items(movement.position(place.body, point))
                known[f"{key}_velocity"] = _items(movement.velocity(place.body, point))
            return value(self.zero, time=movement.time, **known)

        return multibody.RateConstraint(name, law)


def _items(vector: Any) -> tuple[Any, Any, Any]:
    return vector[0], vector[1], vector[2]
