"""Constraints of system files that are written as expressions."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from pydantic import Field

from vehicledyn import multibody
from vehicledyn.base.registry import register
from vehicledyn.files.expressions.fields import Scalar, SystemSet, measured
from vehicledyn.files.system.laws import Values
from vehicledyn.files.system.places import Place

if TYPE_CHECKING:
    from vehicledyn.multibody.model.constraints import Constraint, Geometry, Movement


class ConstraintSet(SystemSet):
    """Base of the constraints that are no classes of the catalogue."""

    @abstractmethod
    def element(self, name: str, value: Values, coordinates: Sequence[str]) -> Constraint:
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

    def element(self, name: str, value: Values, coordinates: Sequence[str]) -> Constraint:
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

    def element(self, name: str, value: Values, coordinates: Sequence[str]) -> Constraint:
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
