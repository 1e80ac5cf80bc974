"""Forward kinematics of bodies: rotations, positions, velocities, accelerations.

Vectors of the recursion are expressed in the axes of their own link (book, chapter 3.3.2).
Everything is evaluated once, on demand.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from vehicledyn.multibody.model.ground import body_axes
from vehicledyn.multibody.model.link_motion import (
    ACCELERATED,
    GROUND_LINK,
    MOVING,
    LinkMotion,
    components,
)
from vehicledyn.symbolic import frames, labels, ops
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

if TYPE_CHECKING:
    from vehicledyn.multibody.model.tree import Tree

_ORIGIN = (0.0, 0.0, 0.0)


class Kinematics(LinkMotion):
    """Kinematics of a tree at given coordinates, rates and (for outputs) accelerations.

    Parameters
    ----------
    tree
        Links of the system.
    coordinates
        Symbol of each coordinate by name.
    rates, accelerations
        Expressions of their derivatives; ``accelerations`` is None while not known yet.
    ground
        Acceleration of the ground in its own axes, shape (3, 1) [m/s²]; None for a ground at
        rest.
    """

    def with_accelerations(self, accelerations: dict[str, Scalar]) -> Kinematics:
        """Return the same kinematics with the accelerations of all coordinates known."""
        return self._sharing(accelerations, self._ground, forget=ACCELERATED)

    def with_rates(self, rates: dict[str, Scalar]) -> Kinematics:
        """Return the kinematics of the same position at other rates."""
        other = self._sharing(None, self._ground, forget=MOVING)
        other._qd = rates
        return other

    def in_lift(self, acceleration: Vec) -> Kinematics:
        """Return the same kinematics on a ground that accelerates, world axes [m/s²].

        On a ground that accelerates against gravity the weights of bodies are inertia forces
        (d'Alembert), so that gravity needs no terms of its own.
        """
        return self._sharing(self._qdd, acceleration, forget=frozenset({"acceleration"}))

    def learn(self, link: int, **known: Mat) -> None:
        """Take what is known of a link by name in place of what would be built for it.

        Names are those under which it is kept: rotation, arm, turn, omega, alpha, beta,
        acceleration; the ground is link -1.
        """
        # What is placed may be shared with other motions of the same position.
        self._placed = dict(self._placed)
        for name, value in known.items():
            self._kept(name)[name, link] = value

    def relative_to(self, link: int) -> Kinematics:
        """Return the kinematics of what hangs on a link as if that link were at rest."""
        other = self._sharing(self._qdd, ops.vector(0.0, 0.0, 0.0), forget=MOVING)
        other._base = link
        return other

    def on(
        self, tree: Tree, moved: Mapping[str, tuple[Scalar, Scalar]] | None = None
    ) -> Kinematics:
        """Return the kinematics of the same motion on another tree.

        ``moved`` are coordinates and rates of the same names that stand for others there; their
        accelerations are zero in both.
        """
        given = moved or {}
        places = self._q | {name: place for name, (place, _) in given.items()}
        rates = self._qd | {name: rate for name, (_, rate) in given.items()}
        return Kinematics(tree, places, rates, self._qdd, self._ground)

    def learn_motion(self, link: int, other: Kinematics) -> None:
        """Take the motion of a station's point from the kinematics of the same motion."""
        self._moving["point motion", link] = other.point_motion(link)

    def joint_motion(self, name: str) -> tuple[Scalar, Scalar, Scalar]:
        """Return a coordinate with its rate and acceleration."""
        return self._q[name], self._qd[name], self._acceleration(name)

    def _sharing(
        self, accelerations: dict[str, Scalar] | None, ground: Vec, *, forget: frozenset[str]
    ) -> Kinematics:
        other = Kinematics(self.tree, self._q, self._qd, accelerations, ground)
        other._base = self._base
        other._placed = self._placed
        other._seen_from = self._seen_from
        if not forget >= MOVING:
            other._moving = {k: v for k, v in self._moving.items() if k[0] not in forget}
        return other

    def coordinate(self, name: str) -> Scalar:
        """Return a joint coordinate [m or rad], of a speed that has none the speed."""
        return self._q[name] if name in self._q else self._qd[name]

    def rate(self, name: str) -> Scalar:
        """Return the rate of a joint coordinate [m/s or rad/s]."""
        return self._qd[name]

    def rotation(self, body: str) -> Mat:
        """Return R with v_world = R v_body."""
        found = self.rotation_in(GROUND_LINK, self.tree.body_link[body])
        return labels.turning(found, to=frames.WORLD, of=body_axes(body))

    def position(self, body: str, point: Sequence[Scalar] = _ORIGIN) -> Vec:
        """Return the world position of a point given in body axes [m]."""
        found = self.position_in(GROUND_LINK, self.tree.body_link[body], _point_of(body, point))
        return labels.in_axes(found, frames.WORLD)

    def velocity(self, body: str, point: Sequence[Scalar] = _ORIGIN) -> Vec:
        """Return the velocity of a point of the body in world axes [m/s]."""
        link, arm = self.tree.body_link[body], _point_of(body, point)
        return self.rotation(body) @ (
            self.link_velocity(link) + ops.cross(self.link_angular_velocity(link), arm)
        )

    def angular_velocity(self, body: str) -> Vec:
        """Return the angular velocity of a body in its own axes [rad/s]."""
        found = self.link_angular_velocity(self.tree.body_link[body])
        return labels.in_axes(found, body_axes(body))

    def acceleration(self, body: str, point: Sequence[Scalar] = _ORIGIN) -> Vec:
        """Return the acceleration of a point of the body in world axes [m/s²]."""
        link, arm = self.tree.body_link[body], _point_of(body, point)
        return self.rotation(body) @ (self.link_acceleration(link) + self.beta(link) @ arm)

    def angular_acceleration(self, body: str) -> Vec:
        """Return the angular acceleration of a body in its own axes [rad/s²]."""
        found = self.link_angular_acceleration(self.tree.body_link[body])
        return labels.in_axes(found, body_axes(body))

    def datum(self, body_a: str, body_b: str) -> tuple[int, int | None]:
        """Return the common ancestor of two bodies and the first link that it carries to them.

        Counted from where that stands, places far from the ancestor's origin lose no digits.
        """
        ancestor = self.tree.common_ancestor(body_a, body_b)
        paths = [self.tree.path(self.tree.body_link[body]) for body in (body_a, body_b)]
        first = [p[p.index(ancestor) + 1] for p in paths if p[-1] != ancestor]
        return ancestor, min(first, default=None)

    def between(self, body_a: str, body_b: str) -> Relative:
        """Return the geometry of two bodies in the axes of their common ancestor."""
        return Relative(self, *self.datum(body_a, body_b))


class Relative:
    """Positions and rotations in the axes of one link, the common ancestor of two bodies.

    Positions count from where the joint of the link ``datum`` stands, see ``position_in``.
    """

    def __init__(self, kinematics: Kinematics, ancestor: int, datum: int | None = None) -> None:
        self._kinematics = kinematics
        self.ancestor = ancestor
        self._datum = datum

    def position(self, body: str, point: Sequence[Scalar] = _ORIGIN) -> Vec:
        """Return the position of a point of a body from the datum, in the ancestor's axes [m]."""
        link = self._kinematics.tree.body_link[body]
        arm = _point_of(body, point)
        found = self._kinematics.position_in(self.ancestor, link, arm, self._datum)
        return labels.in_axes(found, self._axes)

    def rotation(self, body: str) -> Mat:
        """Return R with v_ancestor = R v_body."""
        link = self._kinematics.tree.body_link[body]
        found = self._kinematics.rotation_in(self.ancestor, link)
        return labels.turning(found, to=self._axes, of=body_axes(body))

    @property
    def _axes(self) -> str:
        """Label of the ancestor's axes."""
        return frames.WORLD if self.ancestor == GROUND_LINK else f"link {self.ancestor}"


def _point_of(body: str, point: Sequence[Scalar] | Vec) -> Vec:
    """Return a point given in the axes of a body as a column."""
    frames.require_axes(point, body_axes(body), f"a point of body '{body}'")
    return ops.vector(*components(point))
