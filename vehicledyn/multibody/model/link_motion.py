"""Motion of the links of a tree by the recursion from the ground outwards.

Vectors are expressed in the axes of their own link (book, chapter 3.3.2). Everything is evaluated
once, on demand.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, TypeVar

from vehicledyn.multibody.joints.joint_type import Axes
from vehicledyn.multibody.model.deformed_motion import DeformedMotion
from vehicledyn.multibody.model.tree import Link, Tree, joint_rotation, joint_turns
from vehicledyn.symbolic import ops, rotations

if TYPE_CHECKING:
    from vehicledyn.multibody.model.bodies import Joint
    from vehicledyn.symbolic.ops import Mat, Scalar, Vec

T = TypeVar("T")
ACCELERATED = frozenset({"alpha", "acceleration", "beta"})
"""What is kept of links that depends on accelerations."""
MOVING = ACCELERATED | {"omega", "velocity", "point motion", "slice motion", "slice turn"}
"""What is kept of links that depends on rates."""
GROUND_LINK = -1


class LinkMotion(DeformedMotion):
    """Rotations, positions, velocities and accelerations of links, see ``Kinematics``."""

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
        self._base = GROUND_LINK
        self._placed: dict[tuple[str, int], object] = {}
        self._moving: dict[tuple[str, int], object] = {}
        self._seen_from: dict[int, set[int]] = {}

    def _kept(self, what: str) -> dict[tuple[str, int], object]:
        return self._moving if what in MOVING else self._placed

    def link_rotation(self, link: int) -> Mat:
        """Return R with v_parent = R v_link."""
        return self._once("rotation", link, lambda: self._rotation(link))

    def _rotation(self, link: int) -> Mat:
        item = self.tree.links[link]
        if item.station is not None:
            return self.deflection(link).rotation
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
        if item.turns_otherwise or item.station is not None:
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
        if item.station is not None:
            return offset + self.deflection(link).position
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
            if item.station is not None:
                return carried + self.point_motion(link)[1][0]
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
            if item.station is not None:
                swing = swing + self.point_motion(link)[0][0]
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
            if item.station is not None:
                turning, growth = self.point_motion(link)[1]
                spin_up = growth + self.accelerated(self.deflection(link).angular, link)
                return carried + ops.cross(self.link_angular_velocity(link), turning) + spin_up
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
            if item.station is not None:
                moving, growth = self.point_motion(link)[0]
                at_joint = at_joint + 2.0 * ops.cross(
                    self.link_angular_velocity(item.parent), moving
                )
                at_joint = at_joint + growth
                at_joint = at_joint + self.accelerated(self.deflection(link).linear, link)
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
            w1, w2, w3 = components(self.link_angular_velocity(link))
            a1, a2, a3 = components(self.link_angular_acceleration(link))
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

    def _evaluated_from(self, ancestor: int, link: int) -> int:
        """Return a link between two whose motion relative to it is known, else the parent."""
        parent = between = self.tree.links[link].parent
        known = self._seen_from.get(link)
        while known and between != ancestor:
            if between in known:
                return between
            between = self.tree.links[between].parent
        return parent

    def _acceleration(self, name: str) -> Scalar:
        if self._qdd is None:
            raise ValueError(f"the acceleration of '{name}' is not known at this stage")
        return self._qdd[name]

    def _once(self, what: str, link: int, build: Callable[[], T]) -> T:
        key, kept = (what, link), self._kept(what)
        if key not in kept:
            kept[key] = build()
        return kept[key]  # type: ignore[return-value]


def _plus(vector: Vec, more: Vec | None) -> Vec:
    return vector if more is None else vector + more


def components(vector: Sequence[Scalar] | Vec) -> list[Scalar]:
    """Return the three components of a sequence or of an SX column."""
    return [vector[0], vector[1], vector[2]]
