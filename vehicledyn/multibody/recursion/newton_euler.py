"""Semi-explicit recursive Newton-Euler scheme: the forces that a motion of a tree needs.

M(q) q̈ + c(q, q̇) = Q. ``inverse_dynamics`` is the backward recursion of the book's chapter
3.3.3; with the accelerations that the loops and drives impose at q̈ = 0 it gives the bias c.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence

from vehicledyn.multibody.model.joint_wrench import JointWrench
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import Wrench
from vehicledyn.multibody.model.tree import Tree
from vehicledyn.multibody.recursion import inertia
from vehicledyn.multibody.recursion.body_inertia import BodyInertia, BodyMotion
from vehicledyn.multibody.recursion.flexible_inertia import FlexibleInertia
from vehicledyn.symbolic.ops import Scalar, Vec


def inverse_dynamics(
    kinematics: Kinematics,
    wrenches: Iterable[Wrench],
    gravity: Vec,
    inertias: Sequence[BodyInertia] | None = None,
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
    of_links = inertias_of(kinematics.tree) if inertias is None else inertias
    own = needed_wrenches(kinematics, wrenches, gravity, of_links)
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
        elif item.station is not None:
            _add_all(forces, shares(kinematics, link, total))
    if tree.has_deformable_bodies:
        _add_all(forces, deformation_forces(kinematics.in_lift(-gravity), of_links))
    _add_all(forces, reflected_forces(kinematics))
    return forces, carried


def inertias_of(tree: Tree) -> list[BodyInertia]:
    """Return the inertia of each link's body about its origin."""
    return [
        inertia.of_body(item.body)
        if item.flexibility is None
        else FlexibleInertia(item.flexibility)
        for item in tree.links
    ]


def reflected_forces(kinematics: Kinematics) -> dict[str, Scalar]:
    """Return the forces on coordinates that the inertias reflected on them need, I q̈ [N, N m]."""
    return {
        name: inertia * kinematics.joint_motion(name)[2]
        for name, inertia in kinematics.tree.reflected_inertias.items()
    }


def deformation_forces(lifted: Kinematics, inertias: Sequence[BodyInertia]) -> dict[str, Scalar]:
    """Return the forces on coordinates of deformations that the mass of their bodies needs.

    ``lifted`` is the motion on a ground that accelerates against gravity.
    """
    found: dict[str, Scalar] = {}
    for link, item in enumerate(inertias):
        if isinstance(item, FlexibleInertia):
            pairs = zip(item.body.coordinates, item.at(lifted, link).forces(), strict=True)
            found.update(pairs)
    return found


def shares(kinematics: Kinematics, link: int, wrench: JointWrench) -> dict[str, Scalar]:
    """Return the shares of a wrench at a link on the coordinates that move it on its parent."""
    return {name: wrench.along_axes(axes) for name, axes in kinematics.link_motions(link)}


def _add_all(total: dict[str, Scalar], more: Mapping[str, Scalar]) -> None:
    for name, value in more.items():
        total[name] = total.get(name, 0.0) + value


def needed_wrenches(
    kinematics: Kinematics,
    wrenches: Iterable[Wrench],
    gravity: Vec,
    inertias: Sequence[BodyInertia] | None = None,
) -> list[JointWrench]:
    """Return what each link lacks for its motion: inertia and weight less what acts on it.

    Parameters are those of :func:`inverse_dynamics`; forces act at the link's origin.
    """
    tree = kinematics.tree
    own = inertias or inertias_of(tree)
    applied: dict[int, list[Wrench]] = defaultdict(list)
    for wrench in wrenches:
        applied[tree.body_link[wrench.body]].append(wrench)
    lifted = kinematics.in_lift(-gravity)
    needed = []
    for link, item in enumerate(own):
        force, torque = item.inertial_wrench(BodyMotion(lifted, link))
        for wrench in applied[link]:
            force, torque = force - wrench.force, torque - wrench.torque
        needed.append(JointWrench(force, torque))
    return needed
