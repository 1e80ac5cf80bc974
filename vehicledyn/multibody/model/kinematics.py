"""Forward kinematics along the tree: rotations, positions, velocities, accelerations.

Vectors of the recursion are expressed in the axes of their own link (book, chapter 3.3.2).
Everything is evaluated once, on demand.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

from vehicledyn.multibody.joints.joint_type import Axes
from vehicledyn.multibody.model.bodies import Joint
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.multibody.model.tree import Link, Tree, joint_rotation, joint_turns
from vehicledyn.symbolic import frames, labels, ops, rotations
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

T = TypeVar("T")
_ORIGIN = (0.0, 0.0, 0.0)
_ACCELERATED = frozenset({"alpha", "acceleration", "beta"})
_MOVING = _ACCELERATED | {"omega", "velocity"}
_GROUND = -1


class Kinematics:
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

    def __init__(
        self,
        tree: Tree,
        coordinates: dict[str, Scalar],
        rates: dict[str, Scalar],
        accelerations: dict[str, Scalar] | None = None,
        ground: Vec | None = None,
    ) -> None:
        self.tree = tree
        self._q = coordinates
        self._qd = rates
        self._qdd = accelerations
        self._ground = ops.vector(0.0, 0.0, 0.0) if ground is None else ground
        self._base = _GROUND
        self._placed: dict[tuple[str, int], object] = {}
        self._moving: dict[tuple[str, int], object] = {}
        self._seen_from: dict[int, set[int]] = {}

    def with_accelerations(self, accelerations: dict[str, Scalar]) -> Kinematics:
        """Return the same kinematics with the accelerations of all coordinates known."""
        return self._sharing(accelerations, self._ground, forget=_ACCELERATED)

    def with_rates(self, rates: dict[str, Scalar]) -> Kinematics:
        """Return the kinematics of the same position at other rates."""
        other = self._sharing(None, self._ground, forget=_MOVING)
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
        other = self._sharing(self._qdd, ops.vector(0.0, 0.0, 0.0), forget=_MOVING)
        other._base = link
        return other

    def on(self, tree: Tree) -> Kinematics:
        """Return the kinematics of the same motion on another tree of the same coordinates."""
        return Kinematics(tree, self._q, self._qd, self._qdd, self._ground)

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
        if not forget >= _MOVING:
            other._moving = {k: v for k, v in self._moving.items() if k[0] not in forget}
        return other

    def _kept(self, what: str) -> dict[tuple[str, int], object]:
        return self._moving if what in _MOVING else self._placed

    # -- by body, in world axes ------------------------------------------------------------

    def coordinate(self, name: str) -> Scalar:
        """Return a joint coordinate [m or rad], of a speed that has none the speed."""
        return self._q[name] if name in self._q else self._qd[name]

    def rate(self, name: str) -> Scalar:
        """Return the rate of a joint coordinate [m/s or rad/s]."""
        return self._qd[name]

    def rotation(self, body: str) -> Mat:
        """Return R with v_world = R v_body."""
        found = self.rotation_in(_GROUND, self.tree.body_link[body])
        return labels.turning(found, to=frames.WORLD, of=body_axes(body))

    def position(self, body: str, point: Sequence[Scalar] = _ORIGIN) -> Vec:
        """Return the world position of a point given in body axes [m]."""
        found = self.position_in(_GROUND, self.tree.body_link[body], _point_of(body, point))
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

    # -- by link ---------------------------------------------------------------------------

    def link_rotation(self, link: int) -> Mat:
        """Return R with v_parent = R v_link."""
        return self._once("rotation", link, lambda: self._rotation(link))

    def _rotation(self, link: int) -> Mat:
        item = self.tree.links[link]
        if item.turns_otherwise and item.joint is not None:
            turn = item.joint.type.rotation(self._positions(item.joint))
            return rotations.product(item.before, turn, item.after)
        return joint_rotation(item, *self.link_turn(link))

    def _positions(self, joint: Joint) -> Any:
        """Return the coordinate of a joint, all positions of one that has several."""
        return [self._q[n] for n in joint.positions] if joint.siblings else self._q[joint.name]

    def _at(self, item: Link) -> Scalar:
        """Return the coordinate of a link; a speed alone has none."""
        return self._q.get(item.name, 0.0)

    def link_turns(self, link: int) -> list[Mat]:
        """Return factors of the link's rotation, the innermost first, for inertias."""
        item = self.tree.links[link]
        if item.turns_otherwise:
            return [self.link_rotation(link)]
        return joint_turns(item, *self.link_turn(link))

    def link_turn(self, link: int) -> tuple[Scalar, Scalar]:
        """Return cosine and sine of a joint's angle, those of zero where nothing turns."""

        def build() -> tuple[Scalar, Scalar]:
            item = self.tree.links[link]
            if item.joint is None or item.joint.type.angle_about is None:
                return 1.0, 0.0
            angle = self._q[item.joint.name] + item.phase
            return ops.cos(angle), ops.sin(angle)

        return self._once("turn", link, build)

    def link_arm(self, link: int) -> Vec:
        """Return the vector from the parent's origin to the link's, in the parent's axes [m]."""
        return self._once("arm", link, lambda: self._arm_from(self.tree.links[link].offset, link))

    def _arm_from(self, offset: Vec, link: int) -> Vec:
        """Return a joint's place on its parent with how far the joint has moved from there."""
        item = self.tree.links[link]
        slide = None if item.joint is None else item.joint.type.displacement(self._at(item))
        if slide is None:
            return offset
        return offset + (slide if item.before is None else item.before @ slide)

    def link_axes(self, link: int) -> Axes:
        """Return the axes of a link's joint in the link's axes; none without a joint."""
        item = self.tree.links[link]
        if item.joint is None:
            return Axes()
        axes = item.joint.type.motion(self._at(item))
        return axes if item.after is None else axes.seen_by(item.after)

    def _growth(self, link: int, axis: Vec) -> Vec | None:
        """Return the rate that an axis has relative to the link as it moves, times q̇ again."""
        item = self.tree.links[link]
        if item.type is None or item.type.has_constant_axes:
            return None
        rate = self._qd[item.name]
        return ops.derivative(axis, self._q[item.name], rate) * rate

    def link_angular_velocity(self, link: int) -> Vec:
        """Return the angular velocity of a link in its own axes [rad/s]."""

        def build() -> Vec:
            if link == self._base:
                return ops.vector(0.0, 0.0, 0.0)
            item = self.tree.links[link]
            carried = self.link_rotation(link).T @ self.link_angular_velocity(item.parent)
            axis = self.link_axes(link).angular
            return carried if axis is None else carried + axis * self._qd[item.name]

        return self._once("omega", link, build)

    def link_velocity(self, link: int) -> Vec:
        """Return the velocity of a link's origin in its own axes [m/s]."""

        def build() -> Vec:
            if link == self._base:
                return ops.vector(0.0, 0.0, 0.0)
            item = self.tree.links[link]
            swing = ops.cross(self.link_angular_velocity(item.parent), self.link_arm(link))
            carried = self.link_rotation(link).T @ (self.link_velocity(item.parent) + swing)
            axis = self.link_axes(link).linear
            return carried if axis is None else carried + axis * self._qd[item.name]

        return self._once("velocity", link, build)

    def link_angular_acceleration(self, link: int) -> Vec:
        """Return the angular acceleration of a link in its own axes [rad/s²]."""

        def build() -> Vec:
            if link == self._base:
                return ops.vector(0.0, 0.0, 0.0)
            item = self.tree.links[link]
            carried = self.link_rotation(link).T @ self.link_angular_acceleration(item.parent)
            axis = self.link_axes(link).angular
            if axis is None:
                return carried
            turning = axis * self._qd[item.name]
            spin_up = _plus(axis * self._acceleration(item.name), self._growth(link, axis))
            return carried + ops.cross(self._turned_velocity(link), turning) + spin_up

        return self._once("alpha", link, build)

    def _turned_velocity(self, link: int) -> Vec:
        """Return an angular velocity whose cross product with the joint's own is the Coriolis term.

        It is that of the link; of links that share a joint that before their joint, because their
        speeds are components of one vector.
        """
        joint = self.tree.links[link].joint
        if joint is None or not joint.siblings:
            return self.link_angular_velocity(link)
        first = link
        while not self.tree.links[first].turns_otherwise:
            first = self.tree.links[first].parent
        before = self.tree.links[first].parent
        turn = self.rotation_in(first, link).T @ self.link_rotation(first).T
        return turn @ self.link_angular_velocity(before)

    def link_acceleration(self, link: int) -> Vec:
        """Return the acceleration of a link's origin in its own axes [m/s²]."""

        def build() -> Vec:
            if link == self._base:
                return self._ground
            item = self.tree.links[link]
            base = self.link_acceleration(item.parent)
            at_joint = base + self.beta(item.parent) @ self.link_arm(link)
            carried = self.link_rotation(link).T @ at_joint
            axes = self.link_axes(link)
            axis = axes.linear
            if axis is None:
                return carried
            sliding = axis * self._qd[item.name]
            coriolis = 2.0 * ops.cross(self.link_angular_velocity(link), sliding)
            if axes.angular is not None:
                coriolis = coriolis - ops.cross(axes.angular * self._qd[item.name], sliding)
            speed_up = _plus(axis * self._acceleration(item.name), self._growth(link, axis))
            return carried + coriolis + speed_up

        return self._once("acceleration", link, build)

    def beta(self, link: int) -> Mat:
        """Return tilde(α) + tilde(ω) tilde(ω): acceleration of a point is a + beta arm."""

        def build() -> Mat:
            w1, w2, w3 = _items(self.link_angular_velocity(link))
            a1, a2, a3 = _items(self.link_angular_acceleration(link))
            w11, w22, w33 = w1 * w1, w2 * w2, w3 * w3
            w12, w13, w23 = w1 * w2, w1 * w3, w2 * w3
            return rotations.matrix(
                [
                    [-(w22 + w33), w12 - a3, w13 + a2],
                    [w12 + a3, -(w11 + w33), w23 - a1],
                    [w13 - a2, w23 + a1, -(w11 + w22)],
                ]
            )

        return self._once("beta", link, build)

    def time_derivative(self, expression: Scalar) -> Scalar:
        """Return the rate of an expression of the coordinates, by the chain rule."""
        names = list(self._q)
        return ops.derivative(
            expression,
            ops.column([self._q[n] for n in names]),
            ops.column([self._qd[n] for n in names]),
        )

    # -- relative to an ancestor -----------------------------------------------------------

    def rotation_in(self, ancestor: int, link: int) -> Mat:
        """Return R with v_ancestor = R v_link."""
        if link == ancestor:
            return rotations.identity()
        if ancestor == self.tree.links[link].parent:
            return self.link_rotation(link)

        def build() -> Mat:
            between = self._evaluated_from(ancestor, link)
            return self.rotation_in(ancestor, between) @ self.rotation_in(between, link)

        found = self._once(f"rotation in {ancestor}", link, build)
        self._seen_from.setdefault(link, set()).add(ancestor)
        return found

    def position_in(self, ancestor: int, link: int, point: Vec, datum: int | None = None) -> Vec:
        """Return the position of a point of a link in the axes of an ancestor [m].

        It is counted from where the joint of the link ``datum`` stands on the ancestor, from the
        ancestor's origin if None.
        """
        return self.origin_in(ancestor, link, datum) + self.rotation_in(ancestor, link) @ point

    def origin_in(self, ancestor: int, link: int, datum: int | None = None) -> Vec:
        """Return the position of a link's origin, counted as in :meth:`position_in` [m]."""
        links = self.tree.links
        start = ops.vector(0.0, 0.0, 0.0) if datum is None else links[datum].offset
        if link == ancestor:
            return -start
        if ancestor == links[link].parent:
            return self._arm_from(links[link].offset - start, link)

        def build() -> Vec:
            between = self._evaluated_from(ancestor, link)
            arm = self.rotation_in(ancestor, between) @ self.origin_in(between, link)
            return self.origin_in(ancestor, between, datum) + arm

        return self._once(f"origin in {ancestor} from {datum}", link, build)

    def datum(self, body_a: str, body_b: str) -> tuple[int, int | None]:
        """Return the common ancestor of two bodies and the first link that it carries to them.

        Counted from where that stands, places far from the ancestor's origin lose no digits.
        """
        ancestor = self.tree.common_ancestor(body_a, body_b)
        paths = [self.tree.path(self.tree.body_link[body]) for body in (body_a, body_b)]
        first = [p[p.index(ancestor) + 1] for p in paths if p[-1] != ancestor]
        return ancestor, min(first, default=None)

    def _evaluated_from(self, ancestor: int, link: int) -> int:
        """Return a link between two whose motion relative to it is known, else the parent."""
        parent = between = self.tree.links[link].parent
        known = self._seen_from.get(link)
        while known and between != ancestor:
            if between in known:
                return between
            between = self.tree.links[between].parent
        return parent

    def between(self, body_a: str, body_b: str) -> Relative:
        """Return the geometry of two bodies in the axes of their common ancestor."""
        return Relative(self, *self.datum(body_a, body_b))

    def evaluated(self) -> dict[tuple[str, int], Scalar]:
        """Return what has been evaluated so far, by what it is and the link it belongs to."""
        return {**self._placed, **self._moving}

    def _acceleration(self, name: str) -> Scalar:
        if self._qdd is None:
            raise ValueError(f"the acceleration of '{name}' is not known at this stage")
        return self._qdd[name]

    def _once(self, what: str, link: int, build: Callable[[], T]) -> T:
        key, kept = (what, link), self._kept(what)
        if key not in kept:
            kept[key] = build()
        return kept[key]  # type: ignore[return-value]


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
        return frames.WORLD if self.ancestor == _GROUND else f"link {self.ancestor}"


def body_axes(body: str) -> str:
    """Return the label of the axes of a body; those of the ground are the world's."""
    return frames.WORLD if body == GROUND else frames.axes_of(body)


def _point_of(body: str, point: Sequence[Scalar] | Vec) -> Vec:
    """Return a point given in the axes of a body as a column."""
    frames.require_axes(point, body_axes(body), f"a point of body '{body}'")
    return ops.vector(*_items(point))


def _plus(vector: Vec, more: Vec | None) -> Vec:
    return vector if more is None else vector + more


def _items(vector: Sequence[Scalar] | Vec) -> list[Scalar]:
    """Return the three components of a sequence or of an SX column."""
    return [vector[0], vector[1], vector[2]]
