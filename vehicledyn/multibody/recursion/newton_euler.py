"""Semi-explicit recursive Newton-Euler scheme: bias forces and mass matrix of a tree.

M(q) q̈ + c(q, q̇) = Q. ``inverse_dynamics`` is the backward recursion of the book's chapter
3.3.3; with the accelerations that the loops and drives impose at q̈ = 0 it gives the bias c.
``mass_matrix`` accumulates composite inertias from the leaves (Walker, Orin 1982).
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence

from vehicledyn.multibody.model.joint_wrench import JointWrench
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import Wrench
from vehicledyn.multibody.recursion import inertia
from vehicledyn.multibody.recursion.body_inertia import LinkMotion
from vehicledyn.multibody.recursion.inertia import Inertia
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar, Vec


def inverse_dynamics(
    kinematics: Kinematics,
    wrenches: Iterable[Wrench],
    gravity: Vec,
    inertias: Sequence[Inertia] | None = None,
) -> tuple[dict[str, Scalar], dict[int, JointWrench]]:
    """Return the joint force each coordinate needs, and what each joint transmits.

    Parameters
    ----------
    kinematics
        Kinematics that knows its accelerations.
    wrenches
        What acts on the bodies besides gravity and joints.
    gravity
        Acceleration of free fall in world axes, shape (3, 1) [m/s²].
    inertias
        Inertia of each link, those of the bodies if None. With barycentric parameters the
        joint forces are the same and cheaper, but not what the joints transmit.

    Returns
    -------
    tuple
        Generalised force by coordinate [N or N m], and the wrench of each link's joint.
    """
    tree = kinematics.tree
    own = needed_wrenches(kinematics, wrenches, gravity, inertias)
    carried: dict[int, JointWrench] = {}
    forces: dict[str, Scalar] = {}
    children: dict[int, list[int]] = defaultdict(list)
    for link in reversed(range(len(tree.links))):
        item = tree.links[link]
        total = own[link]
        for child in children[link]:
            rotation, arm = kinematics.link_rotation(child), kinematics.link_arm(child)
            total = total.plus(carried[child], rotation, arm)
        carried[link] = total
        children[item.parent].append(link)
        if item.joint is not None:
            forces[item.joint.name] = total.along(kinematics, link)
    return forces, carried


def needed_wrenches(
    kinematics: Kinematics,
    wrenches: Iterable[Wrench],
    gravity: Vec,
    inertias: Sequence[Inertia] | None = None,
) -> list[JointWrench]:
    """Return what each link lacks for its motion: inertia and weight less what acts on it.

    Parameters are those of :func:`inverse_dynamics`; forces act at the link's origin.
    """
    tree = kinematics.tree
    own = inertias or [inertia.of_body(item.body) for item in tree.links]
    applied: dict[int, list[Wrench]] = defaultdict(list)
    for wrench in wrenches:
        applied[tree.body_link[wrench.body]].append(wrench)
    lifted = kinematics.in_lift(-gravity)
    needed = []
    for link, item in enumerate(own):
        force, torque = item.inertial_wrench(LinkMotion(lifted, link))
        for wrench in applied[link]:
            force, torque = force - wrench.force, torque - wrench.torque
        needed.append(JointWrench(force, torque))
    return needed


def mass_matrix(
    kinematics: Kinematics, names: set[str], inertias: Sequence[Inertia] | None = None
) -> dict[tuple[str, str], Scalar]:
    """Return the entries of M between the named coordinates, both triangles, nonzero ones.

    Only pairs on one branch of the tree have entries. ``inertias`` are those of the links,
    about their origins and in their axes; those of the bodies if None.
    """
    tree = kinematics.tree
    composite = list(inertias or (inertia.of_body(item.body) for item in tree.links))
    entries: dict[tuple[str, str], Scalar] = {}
    for link in reversed(range(len(tree.links))):
        item = tree.links[link]
        if item.parent >= 0:
            moved = composite[link].in_parent(
                kinematics.link_rotation(link), kinematics.link_arm(link)
            )
            composite[item.parent] = composite[item.parent] + moved
        if item.joint is not None and item.joint.name in names:
            column = unit_column(kinematics, link, composite[link], names)
            for other, value in column.items():
                entries[item.joint.name, other] = value
                entries[other, item.joint.name] = value
    return {pair: value for pair, value in entries.items() if not value.is_zero()}


def unit_column(
    kinematics: Kinematics, link: int, composite: Inertia, names: set[str]
) -> dict[str, Scalar]:
    """Return the forces on the named coordinates that a unit acceleration of one needs.

    Parameters
    ----------
    kinematics
        Kinematics of the tree.
    link
        Link whose joint accelerates.
    composite
        Inertia of the link with all beyond it, about the link's origin.
    names
        Coordinates whose forces are asked for; those from the link down to the ground have one.
    """
    links = kinematics.tree.links
    wrench = unit_wrench(kinematics, link, composite)
    found: dict[str, Scalar] = {}
    below = link
    while below >= 0:
        joint = links[below].joint
        if joint is not None and joint.name in names:
            found[joint.name] = wrench.along(kinematics, below)
        wrench = wrench.in_parent(kinematics, below)
        below = links[below].parent
    return found


def unit_wrench(kinematics: Kinematics, link: int, composite: Inertia) -> JointWrench:
    """Return what a unit acceleration of a link's coordinate needs, at its origin and axes."""
    axes = kinematics.link_axes(link)
    parts = []
    if axes.angular is not None:
        force = ops.cross(axes.angular, composite.moment)
        parts.append(JointWrench(force, composite.matrix @ axes.angular))
    if axes.linear is not None:
        torque = ops.cross(composite.moment, axes.linear)
        parts.append(JointWrench(composite.mass * axes.linear, torque))
    return parts[0] if len(parts) == 1 else parts[0].added_to(parts[1])
