"""Where two bodies touch: gap, normal and contact point, and the forces there on both."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from vehicledyn.multibody.model.ground import GROUND
from vehicledyn.multibody.model.kinematics import Kinematics
from vehicledyn.multibody.model.parts import Wrench
from vehicledyn.symbolic import ops
from vehicledyn.symbolic.labels import unlabelled
from vehicledyn.symbolic.ops import Mat, Scalar, Vec


class Placing(Protocol):
    """Positions and rotations of bodies in world axes: kinematics, or what a constraint sees."""

    def position(self, body: str, point: Sequence[Scalar] = ...) -> Vec:
        """Return the world position of a point of a body [m]."""

    def rotation(self, body: str) -> Mat:
        """Return R with v_world = R v_body."""


@dataclass(frozen=True)
class Touch:
    """Two bodies at a place where they touch or come closest, in world axes.

    ``gap`` is positive when apart [m], ``normal`` the unit vector from the first body to the
    second, ``point`` the place of the contact [m].
    """

    gap: Scalar
    normal: Vec
    point: Vec


def pair_of_forces(
    kinematics: Kinematics, bodies: tuple[str, str], touch: Touch, force: Vec
) -> tuple[Wrench, ...]:
    """Return a force on the second body at the contact, and its opposite on the first.

    Parameters
    ----------
    kinematics
        Kinematics of the system.
    bodies
        First and second body.
    touch
        Where they touch.
    force
        Force on the second, world axes [N].
    """
    found = []
    for body, own in ((bodies[0], -force), (bodies[1], force)):
        if body == GROUND:
            continue
        to_body = unlabelled(kinematics.rotation(body)).T
        arm = to_body @ (touch.point - unlabelled(kinematics.position(body)))
        in_body = to_body @ own
        found.append(Wrench(body, in_body, ops.cross(arm, in_body)))
    return tuple(found)


def sliding(kinematics: Kinematics, bodies: tuple[str, str], touch: Touch) -> Vec:
    """Return the velocity of the second body against the first at the contact, across the normal.

    World axes [m/s].
    """
    apart = [_velocity(kinematics, body, touch.point) for body in bodies]
    relative = apart[1] - apart[0]
    return relative - ops.dot(touch.normal, relative) * touch.normal


def _velocity(kinematics: Kinematics, body: str, point: Vec) -> Vec:
    """Return the velocity of the material point of a body at a place, world axes [m/s]."""
    if body == GROUND:
        return ops.vector(0.0, 0.0, 0.0)
    arm = unlabelled(kinematics.rotation(body)).T @ (point - unlabelled(kinematics.position(body)))
    return unlabelled(kinematics.velocity(body, [arm[k] for k in range(3)]))
