"""The tree of links, one a coordinate, that a system's chains of joints unfold into."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from vehicledyn.multibody.joints.joint_type import JointType
from vehicledyn.multibody.model.bodies import Body, Joint
from vehicledyn.multibody.model.deformation import Flexibility, Station
from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.ops import Mat, Scalar, Vec


@dataclass(frozen=True)
class Link:
    """One joint and what it carries.

    ``parent`` is the index of the link before, -1 for the ground. ``offset`` [m] leads from
    the parent's origin to the joint, in the parent's axes; ``before`` and ``after`` are fixed
    rotations on either side of the joint. ``body`` is the body that ends the chain here.
    ``phase`` is added to the coordinate of a turning joint [rad]. A link at a ``station`` has no
    joint; it moves with a point of the deformable body that is its parent.
    """

    parent: int
    offset: Vec
    before: Mat | None
    joint: Joint | None
    after: Mat | None
    body: Body | None
    is_ignorable_spin: bool = False
    phase: Scalar = 0.0
    station: Station | None = None

    @property
    def flexibility(self) -> Flexibility | None:
        """How the body that ends the chain here deforms, if it does."""
        return None if self.body is None else self.body.flexibility

    @property
    def type(self) -> JointType | None:
        """What the joint lets move; None without a joint."""
        return None if self.joint is None else self.joint.type

    @property
    def angle_about(self) -> int | None:
        """Axis about which the axes of the link turn by its coordinate, if that is how they do."""
        return None if self.type is None or self.is_ignorable_spin else self.type.angle_about

    @property
    def turns_otherwise(self) -> bool:
        """Whether the axes of the link turn by another rotation than an angle about one of them."""
        return self.type is not None and self.type.turns_otherwise

    @property
    def name(self) -> str:
        """Name of the coordinate, empty without a joint."""
        return "" if self.joint is None else self.joint.name

    @property
    def turns_about(self) -> int | None:
        """Axis of a pure turn by the coordinate."""
        return None if self.type is None else self.type.turns_about

    @property
    def slides_along(self) -> int | None:
        """Axis of a pure slide by the coordinate."""
        return None if self.type is None else self.type.slides_along


@dataclass(frozen=True)
class Tree:
    """Links, parents first, and the index of the link of each body (-1 for the ground)."""

    links: tuple[Link, ...]
    body_link: dict[str, int]

    def path(self, link: int) -> list[int]:
        """Return the links from the ground to ``link``, both included, ground as -1."""
        path = []
        while link >= 0:
            path.append(link)
            link = self.links[link].parent
        return [-1, *reversed(path)]

    def common_ancestor(self, a: str, b: str) -> int:
        """Return the outermost link that carries both bodies."""
        path_a, path_b = self.path(self.body_link[a]), self.path(self.body_link[b])
        shared = [x for x, y in zip(path_a, path_b, strict=False) if x == y]
        return shared[-1]

    @property
    def reflected_inertias(self) -> dict[str, Scalar]:
        """Inertias that only a coordinate of a joint feels, those that are not zero [kg, kg m²].

        All recursions take them from here: they belong to coordinates, not to bodies.
        """
        joints = (link.joint for link in self.links if link.joint is not None)
        return {
            joint.name: joint.reflected_inertia
            for joint in joints
            if not ops.is_structurally_zero(joint.reflected_inertia)
        }

    @property
    def has_deformable_bodies(self) -> bool:
        """Whether the body of any link deforms."""
        return any(link.flexibility is not None for link in self.links)

    @property
    def speeds(self) -> list[str]:
        """Names of all coordinates that a force acts along: of joints, then of deformations."""
        joints = [link.joint.name for link in self.links if link.joint is not None]
        bodies = (link.flexibility for link in self.links)
        return [
            *joints,
            *(name for body in bodies if body is not None for name in body.coordinates),
        ]

    def force_unit(self, coordinate: str) -> str:
        """Return the unit of the force on a coordinate, "N" or "N*m"."""
        joints = [link.joint for link in self.links if link.joint is not None]
        own = [link.body.joints for link in self.links if link.flexibility and link.body]
        joints += [j for items in own for j in items if isinstance(j, Joint)]
        return next(j.type.force_unit for j in joints if j.name == coordinate)

    def link_name(self, link: int) -> str:
        """Return the name of the body whose axes the link has, "ground" for -1."""
        names = {index: name for name, index in self.body_link.items()}
        return names.get(link, f"link {link}")


def unfold(bodies: Sequence[Body]) -> Tree:
    """Return the tree of elementary links of the bodies of a checked system, parents first."""
    links: list[Link] = []
    body_link = {GROUND: -1}
    for body in bodies:
        parent = body_link[body.parent]
        carrier = links[parent].flexibility if parent >= 0 else None
        if carrier is not None and body.place is not None:
            rests = _is_frame(body)
            none = ops.vector(0.0, 0.0, 0.0)
            station = Station(carrier, body.place)
            own = body if rests else None
            links.append(Link(parent, none, None, None, None, own, station=station))
            parent = body_link[body.name] = len(links) - 1
            if rests:
                continue
        for step in _steps(body):
            offset, before, joint, after, is_last = step
            spin = is_last and body.spins_about is not None
            links.append(
                Link(parent, offset, before, joint, after, body if is_last else None, spin)
            )
            parent = len(links) - 1
        body_link[body.name] = parent
    return Tree(tuple(links), body_link)


def _is_frame(body: Body) -> bool:
    """Return whether a body has the very frame of the point that it hangs on."""
    return not body.joints and body.flexibility is None and ops.vector(*body.at).is_zero()


def _steps(body: Body) -> list[tuple[Vec, Mat | None, Joint | None, Mat | None, bool]]:
    """Split a chain into (offset, turn before, joint, turn after, last?) a joint."""
    joints = [j for j in body.joints if isinstance(j, Joint) and j.type.makes_link]
    turns: list[Mat | None] = [None] * (len(joints) + 1)
    slot = 0
    for item in body.joints:
        if isinstance(item, Joint):
            slot += item.type.makes_link
        else:
            known = turns[slot]
            turns[slot] = item.rotation if known is None else known @ item.rotation
    here, none = ops.vector(*body.at), ops.vector(0.0, 0.0, 0.0)
    if not joints:
        return [(here, turns[0], None, None, True)]
    last = len(joints) - 1
    return [
        (here if k == 0 else none, turns[k], joint, turns[k + 1] if k == last else None, k == last)
        for k, joint in enumerate(joints)
    ]


def joint_rotation(link: Link, c: Scalar, s: Scalar) -> Mat:
    """Return R with v_parent = R v_link, given cosine and sine of the joint's angle [1].

    A joint whose rotation is no turn by its coordinate is not turned.

    Between two fixed turns B and A the joint's R = e eᵀ + c (1 - e eᵀ) + s tilde(e) gives
    B R A as a sum of three constant matrices, which costs half of the two products.
    """
    about = link.angle_about
    if about is None:
        return rotations.product(link.before, link.after)
    if link.before is None or link.after is None:
        return rotations.product(link.before, rotations.turn_by(about, c, s), link.after)
    axis = rotations.axis_vector(about)
    along = axis @ axis.T
    kept, turned, across = (
        link.before @ part @ link.after
        for part in (along, rotations.identity() - along, ops.tilde(axis))
    )
    return kept + c * turned + s * across


def joint_turns(link: Link, c: Scalar, s: Scalar) -> list[Mat]:
    """Return the factors of :func:`joint_rotation`, the innermost first.

    Two turns about axes of their frames, one after the other, are cheaper for an inertia than
    their product; any other rotation is one factor.
    """
    if link.angle_about is not None and link.after is None:
        turn = rotations.turn_by(link.angle_about, c, s)
        if link.before is None:
            return [turn]
        if rotations.elementary_axis(link.before) is not None:
            return [turn, link.before]
    return [joint_rotation(link, c, s)]
