"""Residuals of cuts differentiated through the motion of their places.

Jacobian and quadratic term of a residual r(s(q)), s the positions and rotations it looks at:
∂r/∂q = r_s ∂s/∂q and γ = r_s s̈₀ + d(r_s)/dt ṡ, where the partial velocities ∂s/∂q, the
velocities ṡ and the accelerations s̈₀ at zero q̈ come from the recursion along the tree, relative
to the common ancestor (book, chapters 4.1 and 4.5.1). The Iltis needs a third fewer operations
for its loops than with derivatives of the expanded residuals.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from vehicledyn.multibody.joints.joint_type import Axes
from vehicledyn.multibody.model.cuts import Cut, Residual
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

Partials: TypeAlias = dict[str, Scalar]
"""Derivatives of a column by coordinates."""


@dataclass(frozen=True)
class MovingResidual:
    """A residual r(q), its derivatives {coordinate: ∂r/∂q} and r̈ at zero accelerations."""

    residual: Residual
    slopes: dict[str, Scalar]
    quadratic: Scalar


def moving_residuals(
    cut: Cut, kinematics: Kinematics, known: dict[int, Kinematics] | None = None
) -> list[MovingResidual]:
    """Return the residuals of a cut with their derivatives.

    Parameters
    ----------
    cut
        A cut between two bodies.
    kinematics
        Kinematics of the tree at symbolic coordinates and rates.
    known
        The same as seen from a common ancestor, for each that another cut of the tree has had.
    """
    seen = cut.residuals(kinematics.between(cut.body_a, cut.body_b))
    places = _Places(
        kinematics, *kinematics.datum(cut.body_a, cut.body_b), {} if known is None else known
    )
    looked = cut.residuals(places)
    return [_moving(plain, r, places) for plain, r in zip(seen, looked, strict=True)]


def _moving(plain: Residual, residual: Residual, places: _Places) -> MovingResidual:
    s = places.symbols
    count = s.shape[0]
    speed, lift = ops.symbols("speed", count), ops.symbols("lift", count)
    first = ops.derivative(residual.expression, s, speed)
    second = ops.derivative(first, s, speed) + ops.derivative(first, speed, lift)
    slopes = {
        name: ops.substitute(first, ops.stacked(s, speed), ops.stacked(places.values, partial))
        for name, partial in places.partials.items()
    }
    quadratic = ops.substitute(
        second,
        ops.stacked(s, speed, lift),
        ops.stacked(places.values, places.speeds, places.lifts),
    )
    return MovingResidual(
        plain, {name: v for name, v in slopes.items() if not v.is_zero()}, quadratic
    )


class _Places:
    """Positions and rotations in the axes of an ancestor, as symbols that stand for them."""

    def __init__(
        self,
        kinematics: Kinematics,
        ancestor: int,
        datum: int | None,
        known: dict[int, Kinematics],
    ) -> None:
        self._ancestor, self._datum = ancestor, datum
        if ancestor not in known:
            at_rest = dict.fromkeys(kinematics.tree.speeds, 0.0)
            known[ancestor] = kinematics.with_accelerations(at_rest).relative_to(ancestor)
        self._kinematics = known[ancestor]
        self._columns: list[_Column] = []

    def position(self, body: str, point: Sequence[Scalar]) -> Vec:
        """Return what stands for the position of a point of a body [m]."""
        k, link = self._kinematics, self._kinematics.tree.body_link[body]
        arm = ops.vector(*(point[i] for i in range(3)))
        position = k.position_in(self._ancestor, link, arm, self._datum)
        if link == self._ancestor:
            return position
        turn = k.rotation_in(self._ancestor, link)
        velocity = k.link_velocity(link) + ops.cross(k.link_angular_velocity(link), arm)
        partials = {
            name: _velocity(axes, position - origin) for name, axes, origin in self._joints(link)
        }
        lift = k.link_acceleration(link) + k.beta(link) @ arm
        return self._stand_in(_Column(position, turn @ velocity, turn @ lift, partials))

    def rotation(self, body: str) -> Mat:
        """Return what stands for R with v_ancestor = R v_body."""
        k, link = self._kinematics, self._kinematics.tree.body_link[body]
        turn = k.rotation_in(self._ancestor, link)
        if link == self._ancestor:
            return turn
        rate = turn @ ops.tilde(k.link_angular_velocity(link))
        partials = {
            name: ops.flat(ops.tilde(axes.angular) @ turn)
            for name, axes, _ in self._joints(link)
            if axes.angular is not None
        }
        lift = turn @ k.beta(link)
        column = _Column(ops.flat(turn), ops.flat(rate), ops.flat(lift), partials)
        return ops.unflat(self._stand_in(column), 3)

    @property
    def symbols(self) -> Scalar:
        """Column of all that stands for something."""
        return ops.stacked(*(c.symbols for c in self._columns))

    @property
    def values(self) -> Scalar:
        """What the symbols stand for."""
        return ops.stacked(*(c.value for c in self._columns))

    @property
    def speeds(self) -> Scalar:
        """Their rates."""
        return ops.stacked(*(c.rate for c in self._columns))

    @property
    def lifts(self) -> Scalar:
        """Their second derivatives at zero accelerations of the coordinates."""
        return ops.stacked(*(c.lift for c in self._columns))

    @property
    def partials(self) -> dict[str, Scalar]:
        """Their derivatives by each coordinate that moves any of them."""
        names = dict.fromkeys(name for c in self._columns for name in c.partials)
        return {
            name: ops.stacked(*(c.partials.get(name, c.nothing) for c in self._columns))
            for name in names
        }

    def _stand_in(self, column: _Column) -> Scalar:
        self._columns.append(column)
        return column.symbols

    def _joints(self, link: int) -> list[tuple[str, Axes, Vec]]:
        """Return coordinates from a link to the ancestor, with axes and origin in its axes."""
        k, found = self._kinematics, []
        while link != self._ancestor:
            for name, motion in k.link_motions(link):
                axes = motion.turned(k.rotation_in(self._ancestor, link))
                found.append((name, axes, k.origin_in(self._ancestor, link, self._datum)))
            link = k.tree.links[link].parent
        return found


def _velocity(axes: Axes, arm: Vec) -> Vec:
    """Return the velocity of a point at unit rate of a coordinate, ``arm`` from its origin."""
    if axes.angular is None:
        return axes.linear
    turning = ops.cross(axes.angular, arm)
    return turning if axes.linear is None else turning + axes.linear


class _Column:
    """Symbols for a column of values, with its derivatives."""

    def __init__(self, value: Scalar, rate: Scalar, lift: Scalar, partials: Partials) -> None:
        self.symbols = ops.symbols("place", value.shape[0])
        self.nothing = ops.column([0.0] * value.shape[0])
        # A body that only slides has axes with structural zeros.
        self.value, self.rate, self.lift = map(ops.dense, (value, rate, lift))
        self.partials = {name: ops.dense(partial) for name, partial in partials.items()}
