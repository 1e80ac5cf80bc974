"""Constraints that are no cuts: relations of coordinates, of geometry and time, and of rates.

A holonomic constraint h(q, t) = 0 removes a coordinate. A non-holonomic one,
B(q, t) q̇ + b(q, t) = 0 (book, equation 2.20), removes a rate and leaves all coordinates.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from vehicledyn.multibody.model.cuts import Proportional, Residual
from vehicledyn.symbolic import ops

if TYPE_CHECKING:
    from vehicledyn.multibody.model.kinematics import Kinematics
    from vehicledyn.symbolic.ops import Mat, Scalar, Vec

_ORIGIN = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Geometry:
    """What a holonomic constraint may look at: time, coordinates, positions and rotations."""

    time: Scalar
    kinematics: Kinematics

    def coordinate(self, name: str) -> Scalar:
        """Return a joint coordinate [m or rad]."""
        return self.kinematics.coordinate(name)

    def position(self, body: str, point: Sequence[Scalar] = _ORIGIN) -> Vec:
        """Return the world position of a point given in body axes [m]."""
        return self.kinematics.position(body, point)

    def rotation(self, body: str) -> Mat:
        """Return R with v_world = R v_body."""
        return self.kinematics.rotation(body)


@dataclass(frozen=True)
class Movement(Geometry):
    """What a non-holonomic constraint may look at: the same, and rates and velocities."""

    def rate(self, name: str) -> Scalar:
        """Return the rate of a joint coordinate [m/s or rad/s]."""
        return self.kinematics.rate(name)

    def velocity(self, body: str, point: Sequence[Scalar] = _ORIGIN) -> Vec:
        """Return the velocity of a point of the body in world axes [m/s]."""
        return self.kinematics.velocity(body, point)

    def angular_velocity(self, body: str) -> Vec:
        """Return the angular velocity of a body in its own axes [rad/s]."""
        return self.kinematics.angular_velocity(body)


class Constraint(Protocol):
    """A constraint. Derive from :class:`BaseConstraint` and define what differs from nothing."""

    @property
    def name(self) -> str:
        """Dotted name, unique in the system."""

    def residuals(self, geometry: Geometry) -> list[Residual]:
        """Return the scalars h(q, t) that vanish."""

    def speeds(self, movement: Movement) -> list[Residual]:
        """Return the scalars B q̇ + b that vanish and are no derivatives of ``residuals``."""

    def guesses(self, geometry: Geometry) -> dict[str, Scalar]:
        """Return where coordinates of its own, by name, are looked for at the start."""


@dataclass(frozen=True)
class BaseConstraint:
    """A constraint that demands nothing; the base of all constraints."""

    name: str

    def residuals(self, geometry: Geometry) -> list[Residual]:
        """Demand nothing of the coordinates."""
        return []

    def speeds(self, movement: Movement) -> list[Residual]:
        """Demand nothing of the rates."""
        return []

    def guesses(self, geometry: Geometry) -> dict[str, Scalar]:
        """Leave all coordinates where they were given."""
        return {}


@dataclass(frozen=True)
class LinearConstraint(BaseConstraint):
    """A linear relation of coordinates, Σ factor q = offset, such as a transmission's.

    The first coordinate is best given the factor 1: the multiplier is then the force [N] or
    torque [N m] that the relation puts on it; ``force_unit`` says which. The others get
    their factor times as much; ``more`` are channels that say so.
    """

    terms: tuple[tuple[str, Scalar], ...]
    offset: Scalar = 0.0
    unit: str = "rad"
    force_unit: str = "N*m"
    more: tuple[Proportional, ...] = ()

    def residuals(self, geometry: Geometry) -> list[Residual]:
        """Return the sum less the offset."""
        total = -self.offset
        for coordinate, factor in self.terms:
            total = total + factor * geometry.coordinate(coordinate)
        word = "torque" if self.force_unit == "N*m" else "force"
        text = f"{word.capitalize()} of the transmission on '{self.terms[0][0]}'"
        return [Residual(ops.scalar(total), self.unit, word, self.force_unit, text, more=self.more)]


@dataclass(frozen=True)
class UserConstraint(BaseConstraint):
    """Any holonomic constraint h(q, t) = 0, written as a function of geometry and time.

    ``law`` returns one scalar or several, at least once differentiable twice. The multiplier
    of each is its generalised force λ, in J a ``unit`` of h: the constraint acts with λ ∂h/∂q.
    """

    law: Callable[[Geometry], Scalar | Sequence[Scalar]]
    unit: str = "m"
    force_unit: str = "N"
    meaning: str = "Multiplier λ of the constraint, which acts with λ ∂h/∂q"

    def residuals(self, geometry: Geometry) -> list[Residual]:
        """Return what the function gives."""
        return _numbered(self.law(geometry), self.unit, self.force_unit, self.meaning)


@dataclass(frozen=True)
class RateConstraint(BaseConstraint):
    """Any non-holonomic constraint B(q, t) q̇ + b(q, t) = 0, written as a function.

    ``law`` returns one scalar or several, linear in the rates. The multiplier of each is its
    generalised force λ: the constraint acts with λ B, so that a velocity of a point
    in a direction gives the force on that point in this direction.
    """

    law: Callable[[Movement], Scalar | Sequence[Scalar]]
    unit: str = "m/s"
    force_unit: str = "N"
    meaning: str = "Multiplier λ of the constraint B q̇ + b = 0, which acts with λ B"

    def speeds(self, movement: Movement) -> list[Residual]:
        """Return what the function gives."""
        return _numbered(self.law(movement), self.unit, self.force_unit, self.meaning)


def _numbered(
    given: Scalar | Sequence[Scalar], unit: str, force_unit: str, meaning: str
) -> list[Residual]:
    """Return residuals named multiplier, or multiplier_1, multiplier_2 ... of several."""
    items = list(given) if isinstance(given, list | tuple) else _entries(ops.scalar(given))
    names = (
        ["multiplier"] if len(items) == 1 else [f"multiplier_{k + 1}" for k in range(len(items))]
    )
    return [
        Residual(ops.scalar(item), unit, name, force_unit, meaning)
        for item, name in zip(items, names, strict=True)
    ]


def _entries(column: Scalar) -> list[Scalar]:
    return [column[k] for k in range(column.shape[0] * column.shape[1])]
