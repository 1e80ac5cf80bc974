"""Motion and inertia forces of a tree as steps from link to link, each kind written once."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import partial

from vehicledyn.multibody.model.joint_wrench import JointWrench
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import Wrench
from vehicledyn.multibody.model.tree import Link, Tree
from vehicledyn.multibody.recursion.body_inertia import BodyMotion
from vehicledyn.multibody.recursion.inertia import Inertia
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.ops import Mat, Vec
from vehicledyn.symbolic.shared_steps import Writer

_LINK, _PARENT = 0, -1
_MOTION = ("omega", "alpha", "beta", "acceleration")


def needed_in_steps(
    kinematics: Kinematics,
    wrenches: Iterable[Wrench],
    gravity: Vec,
    inertias: Sequence[Inertia],
    write: Writer,
) -> tuple[Kinematics, list[JointWrench]]:
    """Return what each link lacks for its motion, and kinematics that know rotations and arms.

    The same as :func:`~vehicledyn.multibody.recursion.newton_euler.needed_wrenches`, written in
    steps.
    """
    tree = kinematics.tree
    lifted = kinematics.on(tree).in_lift(-gravity)
    none = ops.vector(0.0, 0.0, 0.0)
    applied: dict[int, tuple[Vec, Vec]] = defaultdict(lambda: (none, none))
    for wrench in wrenches:
        force, torque = applied[tree.body_link[wrench.body]]
        applied[tree.body_link[wrench.body]] = (force + wrench.force, torque + wrench.torque)
    needed = []
    for link, item in enumerate(tree.links):
        own = inertias[link]
        given = [*_given(lifted, link), own.mass, own.moment, own.matrix, *applied[link]]
        kind = item.joint and item.joint.kind
        structure = (item.angle_about, kind, own.thin, item.is_ignorable_spin)
        fixed = (item.before is None, item.after is None)
        motion = partial(_motion, item=item, thin=own.thin)
        rotation, arm, *moved, force, torque = write("motion", (structure, fixed), given, motion)
        lifted.learn(link, rotation=rotation, arm=arm, **dict(zip(_MOTION, moved, strict=True)))
        needed.append(JointWrench(force, torque))
    return lifted, needed


def _given(kinematics: Kinematics, link: int) -> list[Mat]:
    """Return what the motion of a link follows from."""
    item = kinematics.tree.links[link]
    joint = item.joint
    place, rate, acceleration = (
        (0.0, 0.0, 0.0) if joint is None else kinematics.joint_motion(joint.name)
    )
    slides = item.slides_along is not None
    none = ops.column([])
    return [
        ops.column(list(kinematics.link_turn(link)) if item.angle_about else []),
        ops.column([place if slides else 0.0, rate, acceleration]),
        item.offset,
        none if item.before is None else item.before,
        none if item.after is None else item.after,
        kinematics.link_angular_velocity(item.parent),
        kinematics.link_angular_acceleration(item.parent),
        kinematics.beta(item.parent),
        kinematics.link_acceleration(item.parent),
    ]


def _motion(given: list[Mat], *, item: Link, thin: int | None) -> list[Mat]:
    """Return rotation, arm and motion of a link and the wrench it lacks."""
    turn, moving, offset, before, after, *parent = given[:9]
    mass, moment, matrix, force, torque = given[9:]
    link = replace(
        item,
        parent=_PARENT,
        offset=offset,
        before=None if item.before is None else before,
        after=None if item.after is None else after,
    )
    place, rate, acceleration = ({item.name: moving[k]} for k in range(3))
    alone = Kinematics(Tree((link,), {}), place, rate, acceleration)
    alone.learn(_PARENT, **dict(zip(_MOTION, parent, strict=True)))
    if item.angle_about:
        alone.learn(_LINK, turn=(turn[0], turn[1]))
    own = Inertia(mass, moment, matrix, thin)
    own_force, own_torque = own.inertial_wrench(BodyMotion(alone, _LINK))
    return [
        alone.link_rotation(_LINK),
        alone.link_arm(_LINK),
        alone.link_angular_velocity(_LINK),
        alone.link_angular_acceleration(_LINK),
        alone.beta(_LINK),
        alone.link_acceleration(_LINK),
        own_force - force,
        own_torque - torque,
    ]
