"""Recursive direct dynamics of order N: accelerations of an open tree by articulated inertias.

Seen from its parent, a link with all that hangs on it behaves like one body whose inertia is
lower along its free joint (Featherstone 1983, Int. J. Robotics Research 2(1), 13-30; book,
chapter 3.4.3). One sweep inwards finds these inertias, one outwards the accelerations: work
grows with the number of joints, not with its square.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import TypeAlias

from vehicledyn.multibody.joints.joint_type import Axes
from vehicledyn.multibody.model.joint_wrench import JointWrench
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.tree import Link
from vehicledyn.multibody.recursion.articulated_inertia import ArticulatedInertia
from vehicledyn.multibody.recursion.body_inertia import BodyInertia
from vehicledyn.multibody.recursion.floating_body import (
    body_acceleration,
    coordinate_accelerations,
)
from vehicledyn.multibody.recursion.free_joint import effort_of, through_free_joint
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.ops import Mat, Scalar, Vec
from vehicledyn.symbolic.shared_steps import Writer, written_out


@dataclass(frozen=True)
class _Gate:
    """How a free joint yields to its parent: q̈ = push - force · a - torque · α.

    ``force`` and ``torque`` are those of the joint's unit acceleration over its inertia, in the
    axes of the parent; a is the acceleration of the joint's place on the parent.
    """

    force: Vec
    torque: Vec
    push: Scalar


def tree_accelerations(
    kinematics: Kinematics,
    needed: Sequence[JointWrench],
    joint_forces: dict[str, Scalar],
    inertias: Sequence[BodyInertia],
    free: set[str],
    *,
    base: int | None = None,
    write: Writer = written_out,
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
    write
        How the steps of the recursion are written.
    """
    return sweep(kinematics, needed, joint_forces, inertias, free, base=base, write=write)[0]


Carried: TypeAlias = dict[int, list[tuple[ArticulatedInertia, JointWrench]]]
"""What hangs on a link besides other links: inertias and needed wrenches at its origin."""


def sweep(
    kinematics: Kinematics,
    needed: Sequence[JointWrench],
    joint_forces: dict[str, Scalar],
    inertias: Sequence[BodyInertia],
    free: set[str],
    *,
    base: int | None = None,
    links: Sequence[int] | None = None,
    carried: Carried | None = None,
    write: Writer = written_out,
) -> tuple[dict[str, Scalar], dict[int, tuple[Vec, Vec]]]:
    """Return accelerations of the free coordinates and (a, α) of each link.

    Links at the ends of the tree are among them only where ``links`` are given. The other
    parameters are those of :func:`tree_accelerations`.

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
    gates = _inwards(kinematics, bodies, wrenches, joint_forces, free, stop=settled, write=write)
    found: dict[str, Scalar] = {}
    moved = {-1: (ops.vector(0.0, 0.0, 0.0), ops.vector(0.0, 0.0, 0.0))}
    if base is not None:
        body, wrench = bodies[base], wrenches[base]
        blocks = (body.linear, body.coupling, body.angular)
        moved[base] = body_acceleration(blocks, wrench.force, wrench.torque)
        found = coordinate_accelerations(kinematics, base, *moved[base])
    beyond = [link for link in chosen if link not in settled]
    ends = set(beyond) - {item.parent for item in kinematics.tree.links} if links is None else set()
    _outwards(kinematics, gates, beyond, found, moved, ends=ends, write=write)
    return found, moved


def _inwards(
    kinematics: Kinematics,
    bodies: dict[int, ArticulatedInertia],
    wrenches: dict[int, JointWrench],
    joint_forces: dict[str, Scalar],
    free: set[str],
    *,
    stop: set[int],
    write: Writer,
) -> dict[int, _Gate]:
    """Carry inertias and wrenches inwards and return the free joints.

    They are carried to the links of ``stop``, which change, and not further.
    """
    gates: dict[int, _Gate] = {}
    reflected = kinematics.tree.reflected_inertias
    hanging: dict[int, list[Mat]] = defaultdict(list)
    for link in reversed(list(bodies)):
        item = kinematics.tree.links[link]
        own = [*_blocks(bodies[link], wrenches[link]), *hanging.pop(link, [])]
        if link in stop:
            bodies[link], wrenches[link] = _total(own)
            continue
        is_free = item.joint is not None and item.joint.name in free
        given = []
        if item.joint is not None and is_free:
            force = ops.scalar(joint_forces.get(item.joint.name, 0.0))
            given += [_columns(kinematics.link_axes(link), item), force]
            if item.joint.name in reflected:
                given.append(ops.scalar(reflected[item.joint.name]))
        if item.parent >= 0:
            given += [kinematics.link_arm(link), *kinematics.link_turns(link)]
        is_reflecting = is_free and item.name in reflected
        inward = partial(
            _inward, item=item, n_own=len(own), is_free=is_free, is_reflecting=is_reflecting
        )
        structure = (_kind(item), len(own), is_free, is_reflecting, item.parent >= 0)
        found = write("inward", structure, [*own, *given], inward)
        if is_free:
            gates[link] = _Gate(*found[-3:])
        if item.parent >= 0:
            hanging[item.parent] += found[:_PARTS]
    return gates


_PARTS = 5
"""Matrices of an articulated inertia and a wrench."""


def _kind(item: Link) -> tuple[object, ...]:
    """Return what steps ask of a link besides its matrices."""
    axes = (item.turns_about, item.slides_along, item.joint and item.joint.kind)
    return (axes, item.angle_about, item.before is None, item.after is None)


def _columns(axes: Axes, item: Link) -> Mat:
    """Return the axis of a slide or of what only turns as a column, of others both as two."""
    if item.slides_along is not None:
        return axes.linear
    if axes.linear is None:
        return axes.angular
    turning = ops.vector(0.0, 0.0, 0.0) if axes.angular is None else axes.angular
    return ops.unflat(ops.stacked(turning, axes.linear), 3)


def _axes(columns: Mat, item: Link) -> Axes:
    """Return the axes that :func:`_columns` made one matrix."""
    if columns.shape[1] > 1:
        return Axes(columns[:, 0], columns[:, 1])
    return Axes(linear=columns) if item.slides_along is not None else Axes(angular=columns)


def _blocks(body: ArticulatedInertia, wrench: JointWrench) -> list[Mat]:
    return [body.linear, body.coupling, body.angular, wrench.force, wrench.torque]


def _total(parts: Sequence[Mat]) -> tuple[ArticulatedInertia, JointWrench]:
    """Return the sum of inertias and wrenches at the same origin and in the same axes."""
    body, wrench = ArticulatedInertia(*parts[:3]), JointWrench(*parts[3:_PARTS])
    for k in range(_PARTS, len(parts), _PARTS):
        body = body + ArticulatedInertia(*parts[k : k + 3])
        wrench = wrench.added_to(JointWrench(*parts[k + 3 : k + _PARTS]))
    return body, wrench


def _inward(
    given: list[Mat], *, item: Link, n_own: int, is_free: bool, is_reflecting: bool
) -> list[Mat]:
    """Return what a link is for its parent, where there is one, and its gate, where it is free.

    The matrix after the force is the joint's reflected inertia, if it ``is_reflecting``.
    """
    body, wrench = _total(given[:n_own])
    rest = given[n_own:]
    gate: list[Mat] = []
    if is_free:
        axis, force, *rest = rest
        reflected = rest.pop(0) if is_reflecting else None
        effort = effort_of(_axes(axis, item), body, wrench, force, reflected)
        gate = [effort.unit_force, effort.unit_torque, effort.push]
        if item.parent >= 0:
            body, wrench = through_free_joint(item, body, wrench, effort, force)
    if item.parent < 0:
        return gate
    arm, *turns = rest
    for turn in turns:
        gate[:2] = [turn @ row for row in gate[:2]]
    return [*_blocks(body.in_parent(turns, arm), _turned(wrench, turns, arm)), *gate]


def _turned(wrench: JointWrench, turns: Sequence[Mat], arm: Vec) -> JointWrench:
    """Return a wrench in a parent frame: turned by each rotation, origin displaced by ``arm``."""
    force, torque = wrench.force, wrench.torque
    for turn in turns:
        force, torque = turn @ force, turn @ torque
    return JointWrench(force, ops.plus_cross(torque, arm, force))


def _outwards(
    kinematics: Kinematics,
    gates: dict[int, _Gate],
    chosen: Sequence[int],
    found: dict[str, Scalar],
    moved: dict[int, tuple[Vec, Vec]],
    *,
    ends: set[int],
    write: Writer,
) -> None:
    """Add the accelerations of the free joints, and those of the links they lead to but ends."""
    for link in chosen:
        item = kinematics.tree.links[link]
        turns = kinematics.link_turns(link)
        given = [*moved[item.parent], kinematics.link_arm(link), *turns]
        if link in gates:
            gate = gates[link]
            axis = _columns(kinematics.link_axes(link), item)
            given += [axis, gate.force, gate.torque, gate.push]
        outward = partial(_outward, item=item, n_turns=len(turns), is_end=link in ends)
        structure = (_kind(item), link in gates, link in ends)
        *motion, value = write("outward", structure, given, outward)
        if link not in ends:
            moved[link] = (motion[0], motion[1])
        if link in gates and item.joint is not None:
            found[item.joint.name] = value


def _outward(given: list[Mat], *, item: Link, n_turns: int, is_end: bool) -> list[Mat]:
    """Return (a, α) of a link but an end, and the acceleration of its joint, zero without gate.

    The product of the turns is made here: handing it on from where the motion was found takes
    more time than the few products, in a chain too long for the fastest cache.
    """
    linear, angular, arm, *rest = given
    turns, gate = rest[:n_turns], rest[n_turns:]
    at_joint = ops.plus_cross(linear, angular, arm)
    value = ops.scalar(0.0)
    if gate:
        axis, force, torque, value = gate
        for row, motion in ((torque, angular), (force, at_joint)):
            for k in range(3):
                value = value - row[k] * motion[k]
    if is_end:
        return [value]
    rotation = rotations.product(*reversed(turns))
    own_linear, own_angular = rotation.T @ at_joint, rotation.T @ angular
    if not gate:
        return [own_linear, own_angular, value]
    axes = _axes(axis, item)
    if axes.angular is not None:
        own_angular = own_angular + axes.angular * value
    if axes.linear is not None:
        own_linear = own_linear + axes.linear * value
    return [own_linear, own_angular, value]
