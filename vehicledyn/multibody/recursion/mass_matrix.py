"""Mass matrix of a tree by composite inertias (Walker, Orin 1982), deformable bodies included.

What a unit acceleration of a coordinate needs of the links from its own inwards gives the entries
of its column. A coordinate of a deformation accelerates the points of its body and all that hangs
on these: their columns meet at the frame of the body and go on inwards together.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

from vehicledyn.multibody.joints.joint_type import Axes
from vehicledyn.multibody.model.joint_wrench import JointWrench
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.recursion.body_inertia import BodyInertia
from vehicledyn.multibody.recursion.deformed_inertia import DeformedInertia
from vehicledyn.multibody.recursion.flexible_inertia import FlexibleInertia
from vehicledyn.multibody.recursion.inertia import Inertia
from vehicledyn.multibody.recursion.newton_euler import inertias_of
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Scalar

Entries = dict[tuple[str, str], Scalar]


def mass_matrix(
    kinematics: Kinematics, names: set[str], inertias: Sequence[BodyInertia] | None = None
) -> Entries:
    """Return the entries of M between the named coordinates, both triangles, nonzero ones.

    Only pairs on one branch of the tree have entries. Reflected inertias stand on the diagonal.
    ``inertias`` are those of the links,
    about their origins and in their axes; those of the bodies if None.
    """
    links = kinematics.tree.links
    own = inertias or inertias_of(kinematics.tree)
    composite = [_frozen(item, kinematics, link) for link, item in enumerate(own)]
    entries: Entries = {}
    columns: dict[int, dict[str, JointWrench]] = defaultdict(dict)
    for link in reversed(range(len(links))):
        item, body = links[link], own[link]
        if item.parent >= 0:
            moved = composite[link].in_parent(
                kinematics.link_turns(link), kinematics.link_arm(link)
            )
            composite[item.parent] = composite[item.parent] + moved
        if item.joint is not None and item.joint.name in names:
            column = unit_column(kinematics, link, composite[link], names)
            for other, value in column.items():
                entries[item.joint.name, other] = value
                entries[other, item.joint.name] = value
        if item.station is not None:
            found = _at_station(kinematics, link, composite[link], names, entries)
            for name, wrench in found.items():
                known = columns[item.parent].get(name)
                columns[item.parent][name] = wrench if known is None else known.added_to(wrench)
        if isinstance(body, FlexibleInertia):
            _of_body(body.at(kinematics, link), names, entries, columns[link])
    for name, reflected in kinematics.tree.reflected_inertias.items():
        if name in names:
            _enter(entries, name, name, reflected)
    return {pair: value for pair, value in entries.items() if not value.is_zero()}


def _frozen(item: BodyInertia, kinematics: Kinematics, link: int) -> Inertia:
    """Return an inertia with the deformation as it is."""
    if isinstance(item, FlexibleInertia):
        return item.at(kinematics, link).rigid
    if isinstance(item, Inertia):
        return item
    raise ValueError(f"link {link} has an inertia that the mass matrix does not know")


def _at_station(
    kinematics: Kinematics, link: int, composite: Inertia, names: set[str], entries: Entries
) -> dict[str, JointWrench]:
    """Add what hangs on a point to the entries of a deformation; return its columns inwards."""
    motions = [(name, axes) for name, axes in kinematics.link_motions(link) if name in names]
    found: dict[str, JointWrench] = {}
    for index, (name, axes) in enumerate(motions):
        wrench = _wrench_of(axes, composite)
        for other, across in motions[: index + 1]:
            _enter(entries, name, other, wrench.along_axes(across))
        found[name] = wrench.in_parent(kinematics, link)
    return found


def _of_body(
    own: DeformedInertia, names: set[str], entries: Entries, columns: dict[str, JointWrench]
) -> None:
    """Add what the mass of a deformable body gives, and its columns on the links inwards."""
    places = [(k, n) for k, n in enumerate(own.body.coordinates) if n in names]
    for index, (k, name) in enumerate(places):
        for other, across in places[: index + 1]:
            _enter(entries, name, across, own.entry(k, other))
        wrench = own.unit_wrench(k)
        if name in columns:
            wrench = wrench.added_to(columns[name])
        for below, value in _carried(own.kinematics, own.link, wrench, names).items():
            _enter(entries, name, below, value)


def _enter(entries: Entries, name: str, other: str, value: Scalar) -> None:
    total = entries.get((name, other), 0.0) + value
    entries[name, other] = entries[other, name] = total


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
    return _carried(kinematics, link, unit_wrench(kinematics, link, composite), names)


def _carried(
    kinematics: Kinematics, link: int, wrench: JointWrench, names: set[str]
) -> dict[str, Scalar]:
    """Return the shares of a wrench at a link on the named coordinates from there to the ground."""
    links = kinematics.tree.links
    found: dict[str, Scalar] = {}
    below = link
    while below >= 0:
        for name, axes in kinematics.link_motions(below):
            if name in names:
                found[name] = wrench.along_axes(axes)
        wrench = wrench.in_parent(kinematics, below)
        below = links[below].parent
    return found


def unit_wrench(kinematics: Kinematics, link: int, composite: Inertia) -> JointWrench:
    """Return what a unit acceleration of a link's coordinate needs, at its origin and axes."""
    return _wrench_of(kinematics.link_axes(link), composite)


def _wrench_of(axes: Axes, composite: Inertia) -> JointWrench:
    """Return what a unit acceleration along and about some axes needs."""
    parts = []
    if axes.angular is not None:
        force = ops.cross(axes.angular, composite.moment)
        parts.append(JointWrench(force, composite.matrix @ axes.angular))
    if axes.linear is not None:
        torque = ops.cross(composite.moment, axes.linear)
        parts.append(JointWrench(composite.mass * axes.linear, torque))
    return parts[0] if len(parts) == 1 else parts[0].added_to(parts[1])
