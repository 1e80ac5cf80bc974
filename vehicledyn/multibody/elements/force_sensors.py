"""Sensors of forces: what a joint transmits, what a cut or constraint exerts on a body."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

from vehicledyn.base.errors import InputError
from vehicledyn.base.registry import register
from vehicledyn.multibody.model.declaration import (
    ORIGIN,
    body_name,
    choice,
    constraint_name,
    vector,
)
from vehicledyn.multibody.model.joint_wrench import JointWrench
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import (
    BasePart,
    ForcesUnknownError,
    Output,
    Situation,
    TransmittedForces,
)
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.equations import Channel
from vehicledyn.symbolic.ops import Mat, Scalar, Vec

_COMPONENTS = ("x", "y", "z")
_UNITS = {"force": "N", "torque": "N*m"}
Axes: TypeAlias = Literal["world", "body", "parent"]
Shows: TypeAlias = tuple[Literal["force", "torque"], ...]
_log = logging.getLogger(__name__)


@register("sensor_type", "reaction")
@dataclass(frozen=True)
class ReactionSensor(BasePart):
    """Force and torque that the parent of a body exerts on it through the joints between them.

    All that acts through the chain of joints is part of it: along the directions that the
    joints leave free, the springs, drives and transmissions on their coordinates; across
    them, the constraint forces. The body exerts the opposite on its parent. Components that
    redundant constraints leave undetermined are not a number, and a warning names them.
    """

    body: str = body_name("The body that they act on", may_be_ground=False)
    point: Sequence[Scalar] | None = vector(
        "m",
        "Point that the torque is about; without it the origin of the body, or where its joints "
        "start on the parent",
        default=None,
    )
    of: Literal["body", "parent"] = choice(
        "Whose point it is and in whose axes it is given", default="body"
    )
    axes: Axes = choice("Axes that they are given in", default="world")
    shows: Shows = choice("What it shows", default=("force", "torque"))

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the components, named force_x, torque_x and so on."""
        wrench = _forces(self.name, situation).reaction(self.body)
        moved = _about(wrench, self._arm(situation.kinematics))
        return _force_output(self, situation, moved, f"of the joint of '{self.body}' on it")

    def _arm(self, kinematics: Kinematics) -> Vec:
        """Return where the torque is taken, from the body's origin in its axes [m]."""
        if self.of == "body":
            return ops.vector(*(self.point or (0.0, 0.0, 0.0)))
        parent, link = _parent(kinematics, self.body), kinematics.tree.body_link[self.body]
        place = self._start(kinematics) if self.point is None else ops.vector(*self.point)
        from_parent = place - kinematics.origin_in(parent, link)
        return kinematics.rotation_in(parent, link).T @ from_parent

    def _start(self, kinematics: Kinematics) -> Vec:
        """Return where the chain of joints starts, in the axes of the parent [m]."""
        body = kinematics.tree.links[kinematics.tree.body_link[self.body]].body
        if body is None:
            raise InputError(f"sensor '{self.name}': '{self.body}' has no joint")
        return ops.vector(*body.at)


@register("sensor_type", "constraint_force")
@dataclass(frozen=True)
class ConstraintForceSensor(BasePart):
    """Force and torque that a cut or constraint exerts on a body.

    Components that are not unique are not a number.
    """

    constraint: str = constraint_name("The cut or constraint")
    body: str = body_name("The body that they act on", may_be_ground=False)
    point: Sequence[Scalar] = vector(
        "m", "Point that the torque is about, in the axes of the body", default=ORIGIN
    )
    axes: Axes = choice("Axes that they are given in", default="world")
    shows: Shows = choice("What it shows", default=("force", "torque"))

    def outputs(self, situation: Situation) -> tuple[Output, ...]:
        """Return the components, named force_x, torque_x and so on."""
        wrench = _forces(self.name, situation).exerted(self.constraint, self.body)
        moved = _about(wrench, ops.vector(*self.point))
        return _force_output(self, situation, moved, f"of '{self.constraint}' on '{self.body}'")


def _forces(name: str, situation: Situation) -> TransmittedForces:
    if situation.forces is None:
        raise ForcesUnknownError(f"sensor '{name}': forces are known to outputs only")
    return situation.forces


def _about(wrench: JointWrench, arm: Vec) -> JointWrench:
    return JointWrench(wrench.force, wrench.torque - ops.cross(arm, wrench.force))


def _force_output(
    sensor: ReactionSensor | ConstraintForceSensor,
    situation: Situation,
    wrench: JointWrench,
    text: str,
) -> tuple[Output, ...]:
    """Return the outputs of a wrench that is given in the axes of the body."""
    forces, kinematics = _forces(sensor.name, situation), situation.kinematics
    parent = _parent(kinematics, sensor.body)
    to_axes = _rotation(kinematics, sensor.body, sensor.axes, parent)
    frame = {"body": sensor.body, "parent": kinematics.tree.link_name(parent)}
    outputs, vague = [], []
    for word in sensor.shows:
        vector = to_axes @ (wrench.force if word == "force" else wrench.torque)
        values, unique = forces.settled(vector)
        for axis, value, is_unique in zip(_COMPONENTS, values, unique, strict=True):
            name = f"{sensor.name}.{word}_{axis}"
            note = "" if is_unique else "; not unique, constraints are redundant"
            vague += [] if is_unique else [f"{word}_{axis}"]
            words = f"{word.capitalize()} {text}, {axis}{note}"
            channel = Channel(name, _UNITS[word], words, frame.get(sensor.axes, "world"))
            outputs.append(Output(channel, value))
    if vague:
        _log.warning(
            "sensor '%s': %s cannot be determined, since redundant constraints (%s) share the load "
            "in a way that rigid bodies leave open; these channels are not a number",
            sensor.name,
            ", ".join(vague),
            ", ".join(forces.redundant),
        )
    return tuple(outputs)


def _parent(kinematics: Kinematics, body: str) -> int:
    """Return the link of the body that carries a body, the ground for the ground."""
    tree = kinematics.tree
    item = tree.links[tree.body_link[body]].body if tree.body_link[body] >= 0 else None
    return -1 if item is None else tree.body_link[item.parent]


def _rotation(kinematics: Kinematics, body: str, axes: str, parent: int) -> Mat:
    """Return R with v_axes = R v_body."""
    link = kinematics.tree.body_link[body]
    if axes == "body":
        return kinematics.rotation_in(link, link)
    return kinematics.rotation_in(parent if axes == "parent" else -1, link)
