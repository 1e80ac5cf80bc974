"""Recursive direct dynamics of order N: accelerations of an open tree by articulated inertias.

Seen from its parent, a link with all that hangs on it behaves like one body whose inertia is
lower along its free joint (Featherstone 1983, Int. J. Robotics Research 2(1), 13-30; book,
chapter 3.4.3). One sweep inwards finds these inertias, one outwards the accelerations: work
grows with the number of joints, not with its square.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

from vehicledyn.multibody.dynamics import JointWrench
from vehicledyn.multibody.floating import (
    body_acceleration,
    coordinate_accelerations,
)
from vehicledyn.multibody.inertia import Inertia
from vehicledyn.multibody.kinematics import Kinematics
from vehicledyn.multibody.tree import Link
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

_UPPER = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


@dataclass(frozen=True)
class ArticulatedInertia:
    """Force and torque about a frame's origin that its acceleration (a, α) needs.

    force = ``linear`` a + ``coupling`` α and torque = ``coupling``ᵀ a + ``angular`` α, all in
    the frame's axes [kg, kg m, kg m²].
    """

    linear: Mat
    coupling: Mat
    angular: Mat

    @classmethod
    def of(cls, rigid: Inertia) -> ArticulatedInertia:
        """Return that of a rigid body."""
        return cls(rigid.mass * rotations.identity(), -ops.tilde(rigid.moment), rigid.matrix)

    def __add__(self, other: ArticulatedInertia) -> ArticulatedInertia:
        """Return the inertia of both together."""
        return ArticulatedInertia(
            self.linear + other.linear,
            self.coupling + other.coupling,
            self.angular + other.angular,
        )

    def in_parent(self, turns: Sequence[Mat], arm: Vec) -> ArticulatedInertia:
        """Return it in a parent frame: turned by each rotation, origin displaced by ``arm``."""
        linear, near, angular = self.linear, self.coupling, self.angular
        for turn in turns:
            linear, angular = (rotations.congruent(turn, item) for item in (linear, angular))
            near = rotations.similar(turn, near)
        far = near - linear @ ops.tilde(arm)
        one, two = ops.tilde(arm) @ far, ops.tilde(arm) @ near
        gain = [one[i, j] + two[j, i] for i, j in _UPPER]
        return ArticulatedInertia(linear, far, angular + rotations.symmetric(gain[:3], gain[3:]))


@dataclass(frozen=True)
class _Gate:
    """A free joint: the wrench of its unit acceleration, and the same over its inertia.

    ``push`` is the acceleration of the joint when its parent has none.
    """

    force: Vec
    torque: Vec
    unit_force: Vec
    unit_torque: Vec
    push: Scalar


def tree_accelerations(
    kinematics: Kinematics,
    needed: Sequence[JointWrench],
    joint_forces: dict[str, Scalar],
    inertias: Sequence[Inertia],
    free: set[str],
    *,
    base: int | None = None,
) -> dict[str, Scalar]:
    """Return the accelerations q̈ of the free coordinates of an open tree.

    They are counted from the accelerations at which ``needed`` was taken, where those of the
    free coordinates are zero and those of driven ones as given; gravity, gyroscopic terms and
    drives are all in ``needed``.

    Parameters
    ----------
    kinematics
        Kinematics of the tree.
    needed
        Wrench that each link lacks with q̈ = 0, at its origin and in its axes [N, N m].
    joint_forces
        Forces on coordinates by name [N or N m].
    inertias
        Inertia of each link; barycentric ones are as good as those of the bodies and cheaper.
    free
        Names of the coordinates whose accelerations are sought.
    base
        Link of a body that moves freely and whose links below have no inertia, if any.
    """
    return sweep(kinematics, needed, joint_forces, inertias, free, base=base)[0]


Carried: TypeAlias = dict[int, list[tuple[ArticulatedInertia, JointWrench]]]
"""What hangs on a link besides other links: inertias and needed wrenches at its origin."""


def sweep(
    kinematics: Kinematics,
    needed: Sequence[JointWrench],
    joint_forces: dict[str, Scalar],
    inertias: Sequence[Inertia],
    free: set[str],
    *,
    base: int | None = None,
    links: Sequence[int] | None = None,
    carried: Carried | None = None,
) -> tuple[dict[str, Scalar], dict[int, tuple[Vec, Vec]]]:
    """Return accelerations of the free coordinates and (a, α) of each link.

    The other parameters are those of :func:`tree_accelerations`.

    Parameters
    ----------
    links
        Links to look at, parents first; all if None.
    carried
        What hangs on some links besides.
    """
    chosen = range(len(kinematics.tree.links)) if links is None else links
    bodies = {link: ArticulatedInertia.of(inertias[link]) for link in chosen}
    wrenches = {link: needed[link] for link in chosen}
    for link, items in (carried or {}).items():
        for body, wrench in items:
            bodies[link] = bodies[link] + body
            force, torque = wrenches[link].force, wrenches[link].torque
            wrenches[link] = JointWrench(force + wrench.force, torque + wrench.torque)

    settled = set() if base is None else set(kinematics.tree.path(base))
    gates = _inwards(kinematics, bodies, wrenches, joint_forces, free, stop=settled)
    found: dict[str, Scalar] = {}
    moved = {-1: (ops.vector(0.0, 0.0, 0.0), ops.vector(0.0, 0.0, 0.0))}
    if base is not None:
        body, wrench = bodies[base], wrenches[base]
        blocks = (body.linear, body.coupling, body.angular)
        moved[base] = body_acceleration(blocks, wrench.force, wrench.torque)
        found = coordinate_accelerations(kinematics, base, *moved[base])
    beyond = [link for link in chosen if link not in settled]
    _outwards(kinematics, gates, beyond, found, moved)
    return found, moved


def _inwards(
    kinematics: Kinematics,
    bodies: dict[int, ArticulatedInertia],
    wrenches: dict[int, JointWrench],
    joint_forces: dict[str, Scalar],
    free: set[str],
    *,
    stop: set[int],
) -> dict[int, _Gate]:
    """Carry inertias and wrenches inwards, changing both, and return the free joints.

    They are carried to the links of ``stop``, not further.
    """
    gates: dict[int, _Gate] = {}
    for link in reversed(list(bodies)):
        if link in stop:
            continue
        item, body, wrench = kinematics.tree.links[link], bodies[link], wrenches[link]
        if item.joint is not None and item.joint.name in free:
            force = ops.scalar(joint_forces.get(item.joint.name, 0.0))
            axis = kinematics.link_axis(link)
            gates[link] = gate = _gate(item, axis, body, wrench, force)
            if item.parent >= 0:
                body, wrench = _beyond(item, body, wrench, gate, force)
        if item.parent >= 0:
            rotation, arm = kinematics.link_rotation(link), kinematics.link_arm(link)
            moved = body.in_parent(kinematics.link_turns(link), arm)
            bodies[item.parent] = bodies[item.parent] + moved
            wrenches[item.parent] = wrenches[item.parent].plus(wrench, rotation, arm)
    return gates


def _gate(
    item: Link, axis: Vec, body: ArticulatedInertia, wrench: JointWrench, force: Scalar
) -> _Gate:
    if item.joint is not None and item.joint.is_rotation:
        column, turning, along = body.coupling @ axis, body.angular @ axis, wrench.torque
        inverse = 1.0 / ops.dot(axis, turning)
    else:
        column, turning, along = body.linear @ axis, body.coupling.T @ axis, wrench.force
        inverse = 1.0 / ops.dot(axis, column)
    push = (force - ops.dot(axis, along)) * inverse
    return _Gate(column, turning, column * inverse, turning * inverse, push)


def _beyond(
    item: Link, body: ArticulatedInertia, wrench: JointWrench, gate: _Gate, along: Scalar
) -> tuple[ArticulatedInertia, JointWrench]:
    """Return inertia and wrench as they are felt through a free joint.

    Along the joint nothing is felt but its own force. Where the joint's axis is one of the
    link's these entries are entered as what they are, not computed.
    """
    f, t, uf, ut = gate.force, gate.torque, gate.unit_force, gate.unit_torque
    turns = item.joint is not None and item.joint.is_rotation
    along_axis = item.joint.axis - 1 if item.joint is not None and item.after is None else None
    felt = set(range(3)) - {along_axis}
    row, column = (range(3), felt) if turns else (felt, range(3))
    linear = [body.linear[i, j] - f[i] * uf[j] if i in row and j in row else 0.0 for i, j in _UPPER]
    angular = [
        body.angular[i, j] - t[i] * ut[j] if i in column and j in column else 0.0 for i, j in _UPPER
    ]
    coupling = [
        [body.coupling[i, j] - f[i] * ut[j] if i in row and j in column else 0.0 for j in range(3)]
        for i in range(3)
    ]
    force = [wrench.force[k] + f[k] * gate.push if k in row else along for k in range(3)]
    torque = [wrench.torque[k] + t[k] * gate.push if k in column else along for k in range(3)]
    return (
        ArticulatedInertia(
            rotations.symmetric(linear[:3], linear[3:]),
            rotations.matrix(coupling),
            rotations.symmetric(angular[:3], angular[3:]),
        ),
        JointWrench(ops.vector(*force), ops.vector(*torque)),
    )


def _outwards(
    kinematics: Kinematics,
    gates: dict[int, _Gate],
    chosen: Sequence[int],
    found: dict[str, Scalar],
    moved: dict[int, tuple[Vec, Vec]],
) -> None:
    """Add the accelerations of the free joints, and those of the links they lead to."""
    for link in chosen:
        item = kinematics.tree.links[link]
        linear, angular = moved[item.parent]
        back = kinematics.link_rotation(link).T
        linear = back @ (linear + ops.cross(angular, kinematics.link_arm(link)))
        angular = back @ angular
        if link in gates and item.joint is not None:
            gate, axis = gates[link], kinematics.link_axis(link)
            carried = ops.dot(gate.unit_force, linear) + ops.dot(gate.unit_torque, angular)
            value = found[item.joint.name] = gate.push - carried
            if item.joint.is_rotation:
                angular = angular + axis * value
            else:
                linear = linear + axis * value
        moved[link] = (linear, angular)
