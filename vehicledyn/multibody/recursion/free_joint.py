"""How a free joint yields: the inertia along it, and what is felt of a link beyond it."""

from __future__ import annotations

from dataclasses import dataclass

from vehicledyn.multibody.joints.joint_type import Axes
from vehicledyn.multibody.model.joint_wrench import JointWrench
from vehicledyn.multibody.model.tree import Link
from vehicledyn.multibody.recursion.articulated_inertia import UPPER, ArticulatedInertia
from vehicledyn.symbolic import ops, rotations
from vehicledyn.symbolic.ops import Scalar, Vec


@dataclass(frozen=True)
class Effort:
    """The wrench of a joint's unit acceleration, the same over its inertia, and its push.

    The inertia is that of the bodies and the reflected one; ``kept`` is the share of the latter,
    which the parent feels of an inertia along the joint. It is None where there is none.
    """

    force: Vec
    torque: Vec
    unit_force: Vec
    unit_torque: Vec
    push: Scalar
    kept: Scalar | None

    def inertia_kept(self, value: Scalar) -> Scalar:
        """Return what is left beyond the joint of an entry of the inertia along its axis."""
        return 0.0 if self.kept is None else self.kept * value

    def force_through(self, own: Scalar, given: Scalar) -> Scalar:
        """Return what is felt beyond the joint along its axis, of ``own`` and the given force."""
        return given if self.kept is None else given + self.kept * (own - given)


def effort_of(
    axes: Axes,
    body: ArticulatedInertia,
    wrench: JointWrench,
    force: Scalar,
    reflected: Scalar | None,
) -> Effort:
    """Return what a joint's unit acceleration takes; ``reflected`` is its reflected inertia."""
    turns, slides = axes.angular, axes.linear
    if slides is None:
        column, turning = body.coupling @ turns, body.angular @ turns
        resisting, along = ops.dot(turns, turning), ops.dot(turns, wrench.torque)
    elif turns is None:
        column, turning = body.linear @ slides, body.coupling.T @ slides
        resisting, along = ops.dot(slides, column), ops.dot(slides, wrench.force)
    else:
        column = body.linear @ slides + body.coupling @ turns
        turning = body.coupling.T @ slides + body.angular @ turns
        resisting = ops.dot(slides, column) + ops.dot(turns, turning)
        along = ops.dot(slides, wrench.force) + ops.dot(turns, wrench.torque)
    inverse = 1.0 / (resisting if reflected is None else resisting + reflected)
    push = (force - along) * inverse
    kept = None if reflected is None else reflected * inverse
    return Effort(column, turning, column * inverse, turning * inverse, push, kept)


def through_free_joint(
    item: Link, body: ArticulatedInertia, wrench: JointWrench, gate: Effort, along: Scalar
) -> tuple[ArticulatedInertia, JointWrench]:
    """Return inertia and wrench as they are felt through a free joint.

    Along the joint nothing is felt but its own force, and of the inertia what a reflected one
    keeps. Where the joint's axis is one of the link's these entries are entered as what they are,
    not computed.
    """
    f, t, uf, ut = gate.force, gate.torque, gate.unit_force, gate.unit_torque
    turns, slides = (
        set() if axis is None or item.after is not None else {axis - 1}
        for axis in (item.turns_about, item.slides_along)
    )
    row, column = set(range(3)) - slides, set(range(3)) - turns
    kept, through = gate.inertia_kept, gate.force_through
    lin, ang, cou = body.linear, body.angular, body.coupling
    linear = [
        lin[i, j] - f[i] * uf[j] if i in row and j in row else kept(lin[i, j]) for i, j in UPPER
    ]
    angular = [
        ang[i, j] - t[i] * ut[j] if i in column and j in column else kept(ang[i, j])
        for i, j in UPPER
    ]
    coupling = [
        [
            cou[i, j] - f[i] * ut[j] if i in row and j in column else kept(cou[i, j])
            for j in range(3)
        ]
        for i in range(3)
    ]
    given, turning = wrench.force, wrench.torque
    force = [
        given[k] + f[k] * gate.push if k in row else through(given[k], along) for k in range(3)
    ]
    torque = [
        turning[k] + t[k] * gate.push if k in column else through(turning[k], along)
        for k in range(3)
    ]
    return (
        ArticulatedInertia(
            rotations.symmetric(linear[:3], linear[3:]),
            rotations.matrix(coupling),
            rotations.symmetric(angular[:3], angular[3:]),
        ),
        JointWrench(ops.vector(*force), ops.vector(*torque)),
    )
