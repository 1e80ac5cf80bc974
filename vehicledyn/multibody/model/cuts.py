"""Loop cuts: the constraints that close a loop of the tree again (book, chapter 4.1).

A cut gives residuals in the axes of the common ancestor of its two bodies, so that they depend
on the coordinates of the loop alone. The multiplier of a residual is a force or torque.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from vehicledyn.base.shapes import Anchor, Ball, Shape, Tube
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.labels import unlabelled
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

_AXES = ("x", "y", "z")


@dataclass(frozen=True)
class Proportional:
    """A force that is a multiple of a multiplier: its channel, unit, factor and meaning."""

    channel: str
    unit: str
    factor: Scalar
    description: str


@dataclass(frozen=True)
class Residual:
    """One scalar of a constraint: zero when closed.

    ``force_channel`` names the multiplier's channel, ``sign`` turns the multiplier into it;
    ``more`` are further forces that are multiples of the multiplier. A constraint on coordinates
    that no force acts on has no channel, an empty name.
    """

    expression: Scalar
    unit: str
    force_channel: str
    force_unit: str
    force_description: str
    sign: float = 1.0
    more: tuple[Proportional, ...] = ()


class RelativeGeometry(Protocol):
    """Positions and rotations of two bodies in the axes of their common ancestor."""

    def position(self, body: str, point: Sequence[Scalar]) -> Vec:
        """Return the position of a point of a body [m]."""

    def rotation(self, body: str) -> Mat:
        """Return R with v_ancestor = R v_body."""


class Cut(Protocol):
    """A constraint between two bodies."""

    @property
    def name(self) -> str:
        """Dotted name, unique in the system."""

    @property
    def body_a(self) -> str:
        """First body."""

    @property
    def body_b(self) -> str:
        """Second body."""

    def residuals(self, geometry: RelativeGeometry) -> list[Residual]:
        """Return the scalars that vanish when the loop is closed."""


@dataclass(frozen=True)
class BallCut:
    """A ball joint cut open: two points coincide.

    The multipliers are the force on body B at the point, in the axes of the common ancestor.
    """

    name: str
    body_a: str
    point_a: Sequence[Scalar]
    body_b: str
    point_b: Sequence[Scalar]

    def residuals(self, geometry: RelativeGeometry) -> list[Residual]:
        """Return the three components of the gap [m]."""
        gap = geometry.position(self.body_b, self.point_b) - geometry.position(
            self.body_a, self.point_a
        )
        text = f"Force on {self.body_b} in the cut ball joint"
        return [
            Residual(gap[k], "m", f"force_{axis}", "N", f"{text}, {axis}")
            for k, axis in enumerate(_AXES)
        ]

    def shapes(self) -> tuple[Shape, ...]:
        """Return the ball, which holds on to both bodies."""
        return _balls(self.name, self.body_a, self.point_a, self.body_b, self.point_b)


@dataclass(frozen=True)
class RodCut:
    """A massless rod with a ball joint at each end, cut away: a distance is constant.

    With d the vector between the ends and L the length, the residual (d² - L²)/(2 L) has the
    unit direction of the rod as gradient, so the multiplier is the axial force.
    """

    name: str
    body_a: str
    point_a: Sequence[Scalar]
    body_b: str
    point_b: Sequence[Scalar]
    length: Scalar

    def residuals(self, geometry: RelativeGeometry) -> list[Residual]:
        """Return the scalar that vanishes when the ends are one length apart [m]."""
        d = geometry.position(self.body_b, self.point_b) - geometry.position(
            self.body_a, self.point_a
        )
        stretch = (ops.dot(d, d) - self.length * self.length) / (2.0 * self.length)
        return [
            Residual(stretch, "m", "axial_force", "N", "Axial force, positive in tension", -1.0)
        ]

    def shapes(self) -> tuple[Shape, ...]:
        """Return the rod."""
        a, b = Anchor(self.body_a, tuple(self.point_a)), Anchor(self.body_b, tuple(self.point_b))
        return (Tube(self.name, a, b, style="rod"),)


@dataclass(frozen=True)
class BodyCut:
    """A body cut in two: position and orientation of two frames coincide.

    The orientation residuals are twice the Rodrigues vector of the rotation from A to B,
    2 tan(θ/2) n = 2 axial(R)/(1 + tr R) with axial(R) = (R₃₂ - R₂₃, ...): they vanish where
    the frames coincide and nowhere else, have the angular velocity as rate there, and grow
    without bound towards half a turn, so that no assembly ends with a frame upside down. The
    multipliers are the torque on body B in the axes of the common ancestor.
    """

    name: str
    body_a: str
    point_a: Sequence[Scalar]
    body_b: str
    point_b: Sequence[Scalar]

    def residuals(self, geometry: RelativeGeometry) -> list[Residual]:
        """Return three gaps [m] and three pseudo-rotations [rad]."""
        ball = BallCut(self.name, self.body_a, self.point_a, self.body_b, self.point_b)
        turns_a, turns_b = (
            unlabelled(geometry.rotation(body)) for body in (self.body_a, self.body_b)
        )
        twist = turns_b @ turns_a.T
        axial = (twist[2, 1] - twist[1, 2], twist[0, 2] - twist[2, 0], twist[1, 0] - twist[0, 1])
        scale = 2.0 / (1.0 + twist[0, 0] + twist[1, 1] + twist[2, 2])
        text = f"Torque on {self.body_b} in the cut section"
        turns = [
            Residual(scale * value, "rad", f"torque_{axis}", "N*m", f"{text}, {axis}")
            for value, axis in zip(axial, _AXES, strict=True)
        ]
        return [*ball.residuals(geometry), *turns]

    def shapes(self) -> tuple[Shape, ...]:
        """Return a mark where the body is cut, which holds on to both sides."""
        return _balls(self.name, self.body_a, self.point_a, self.body_b, self.point_b)


def _balls(
    name: str, body_a: str, point_a: Sequence[Scalar], body_b: str, point_b: Sequence[Scalar]
) -> tuple[Shape, ...]:
    """Return the balls at the points of both bodies, which coincide when the loop is closed."""
    return Ball(name, Anchor(body_a, tuple(point_a))), Ball(name, Anchor(body_b, tuple(point_b)))
